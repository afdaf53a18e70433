//! A whole update against a reference that shares nothing with it: scalar arithmetic in double precision, gradients by
//! central differences of the losses as the paper writes them.

use crate::algorithm::Batch;
use crate::algorithm::fixtures::{ACTION, OBSERVATION, ROWS, batch};
use crate::algorithm::iql::networks::HEADS;
use crate::algorithm::iql::{Iql, IqlConfig};
use crate::nn::fixtures::{BACKENDS, assert_close, numbers, values, wide};
use crate::nn::scalar::{ScalarAdam, ScalarMlp, central_differences, flat};
use crate::nn::{Adam, Backend};

use super::{config, learner};

/// One lane of implicit Q-learning.
struct Reference {
    config: IqlConfig,
    value: ScalarMlp,
    /// The mean's parameters, then the log standard deviations.
    actor: ScalarMlp,
    log_std: Vec<f64>,
    critics: Vec<ScalarMlp>,
    targets: Vec<ScalarMlp>,
    value_adam: ScalarAdam,
    actor_adam: ScalarAdam,
    log_std_adam: ScalarAdam,
    critic_adams: Vec<ScalarAdam>,
    step: i32,
}

/// A row of a batch.
struct Transition {
    observation: Vec<f64>,
    next_observation: Vec<f64>,
    action: Vec<f64>,
    pair: Vec<f64>,
    reward: f64,
    discount: f64,
}

fn transitions(batch: &Batch) -> Vec<Transition> {
    let row = |all: &[f32], width: usize, i: usize| wide(&all[i * width..(i + 1) * width]);
    (0..ROWS)
        .map(|i| {
            let observation = row(&batch.observations, OBSERVATION, i);
            let action = row(&batch.actions, ACTION, i);
            Transition {
                pair: [observation.clone(), action.clone()].concat(),
                observation,
                next_observation: row(&batch.next_observations, OBSERVATION, i),
                action,
                reward: batch.rewards[i].into(),
                discount: batch.discounts[i].into(),
            }
        })
        .collect()
}

fn mean(terms: impl Iterator<Item = f64>) -> f64 {
    terms.sum::<f64>() / ROWS as f64
}

impl Reference {
    fn new(iql: &Iql) -> Self {
        let value = ScalarMlp::member(&iql.value, 0);
        let actor = ScalarMlp::member(&iql.actor, 0);
        let heads =
            |network| -> Vec<_> { (0..HEADS).map(|h| ScalarMlp::member(network, h)).collect() };
        let critics = heads(&iql.critic);
        Self {
            config: iql.config().clone(),
            value_adam: ScalarAdam::new(iql.config().adam, value.parameters.len()),
            actor_adam: ScalarAdam::new(iql.config().adam, actor.parameters.len()),
            log_std_adam: ScalarAdam::new(iql.config().adam, ACTION),
            critic_adams: critics
                .iter()
                .map(|c| ScalarAdam::new(iql.config().adam, c.parameters.len()))
                .collect(),
            log_std: wide(&values(iql.log_std.clone())),
            targets: heads(&iql.target),
            critics,
            value,
            actor,
            step: 0,
        }
    }

    /// Order: V; then, with the new V, the policy and Q; the targets last.
    fn update(&mut self, batch: &[Transition]) {
        let config = self.config.clone();
        let progress = f64::from(self.step) / config.steps as f64;
        let actor_rate =
            config.learning_rate * (1.0 + (std::f64::consts::PI * progress).cos()) / 2.0;
        self.step += 1;
        let rate = config.learning_rate;

        let q_target: Vec<f64> = batch
            .iter()
            .map(|t| {
                let heads = self.targets.iter().map(|net| net.forward(&t.pair)[0]);
                heads.fold(f64::INFINITY, f64::min)
            })
            .collect();
        let gradient = central_differences(&self.value.parameters, |p| {
            let value = self.value.with(p);
            mean(batch.iter().zip(&q_target).map(|(t, q)| {
                let u = q - value.forward(&t.observation)[0];
                let weight = if u < 0.0 {
                    1.0 - config.tau
                } else {
                    config.tau
                };
                weight * u * u
            }))
        });
        self.value_adam
            .step(&mut self.value.parameters, &gradient, rate);

        let policy_loss = |actor: &ScalarMlp, log_std: &[f64]| {
            mean(batch.iter().zip(&q_target).map(|(t, q)| {
                let advantage = q - self.value.forward(&t.observation)[0];
                let weight = (config.beta * advantage).exp().min(config.advantage_clip);
                let mean = actor.forward(&t.observation);
                let log_prob = |i: usize| {
                    let log_std = log_std[i].clamp(config.log_std[0], config.log_std[1]);
                    let z = (t.action[i] - mean[i]) / log_std.exp();
                    -0.5 * z * z - log_std - 0.5 * std::f64::consts::TAU.ln()
                };
                -weight * (0..ACTION).map(log_prob).sum::<f64>()
            }))
        };
        let d_actor = central_differences(&self.actor.parameters, |p| {
            policy_loss(&self.actor.with(p), &self.log_std)
        });
        let d_log_std = central_differences(&self.log_std, |p| policy_loss(&self.actor, p));
        self.actor_adam
            .step(&mut self.actor.parameters, &d_actor, actor_rate);
        self.log_std_adam
            .step(&mut self.log_std, &d_log_std, actor_rate);

        for (critic, own_adam) in self.critics.iter_mut().zip(&mut self.critic_adams) {
            let gradient = central_differences(&critic.parameters, |p| {
                let critic = critic.with(p);
                mean(batch.iter().map(|t| {
                    let y = t.reward + t.discount * self.value.forward(&t.next_observation)[0];
                    (critic.forward(&t.pair)[0] - y).powi(2)
                }))
            });
            own_adam.step(&mut critic.parameters, &gradient, rate);
        }
        for (target, critic) in self.targets.iter_mut().zip(&self.critics) {
            for (old, new) in target.parameters.iter_mut().zip(&critic.parameters) {
                *old += config.target_rate * (new - *old);
            }
        }
    }
}

/// A learner whose parameters are all different from each other: fresh ones have biases of zero, where ReLU has a kink,
/// and targets equal to the critics.
fn anywhere(config: &IqlConfig, backend: Backend) -> Iql {
    let mut iql = learner(config, &[1], backend);
    let mut state = iql.checkpoint(0, [0; 32]);
    for tensor in &mut state.tensors {
        if !tensor.name.starts_with("adam/") {
            tensor.values = numbers(tensor.values.len(), &tensor.name);
        }
    }
    iql.restore(&[&state]).unwrap();
    iql
}

#[test]
fn updates_are_those_of_the_scalar_reference_in_every_parameter() {
    /// What single precision loses in three updates; a V taken before its update, a target network moved first or a
    /// constant actor rate are off by more than a hundred times that.
    const TOLERANCE: f64 = 5e-6;
    let config = IqlConfig {
        // Adam divides small gradients by their own size; with a larger epsilon rounding is not blown up by that.
        adam: Adam {
            epsilon: 1e-2,
            ..Adam::default()
        },
        learning_rate: 0.05,
        steps: 6,
        ..config()
    };
    for backend in BACKENDS {
        let mut iql = anywhere(&config, backend);
        let mut reference = Reference::new(&iql);
        for step in 0..3 {
            let batch = batch(&[1], step);
            iql.update(&batch);
            reference.update(&transitions(&batch));
            let what = |name: &str| format!("{backend:?}, {name} after update {}", step + 1);
            let close = |name: &str, actual: &[f32], expected: &[f64]| {
                assert_close(actual, expected, TOLERANCE, &what(name));
            };
            close(
                "value",
                &flat(&iql.value.parameters.layers(), 0),
                &reference.value.parameters,
            );
            close(
                "actor",
                &flat(&iql.actor.parameters.layers(), 0),
                &reference.actor.parameters,
            );
            close("log std", &values(iql.log_std.clone()), &reference.log_std);
            for head in 0..HEADS {
                let critic = flat(&iql.critic.parameters.layers(), head);
                close("critic", &critic, &reference.critics[head].parameters);
                let target = flat(&iql.target.parameters.layers(), head);
                close("target", &target, &reference.targets[head].parameters);
            }
        }
    }
}
