//! Whole iterations against a reference that shares nothing with them but the batches: scalar arithmetic in double precision,
//! returns by the sum over look-aheads that TD(lambda) is short for, gradients by central differences.

use crate::algorithm::Replay;
use crate::dataset::fixtures::SHAPE;
use crate::nn::fixtures::{BACKENDS, assert_close, wide};
use crate::nn::scalar::{ScalarMlp, central_differences, flat};
use crate::rng::Seed;

use super::{ROWS, config, dataset, learner, replay};

/// The return of step `t` of an episode: a mixture of all look-aheads, `n` steps with weight `(1 - lambda) lambda^(n-1)` and the
/// longest with what is left.
fn mixed_return(rewards: &[f64], discounts: &[f64], values: &[f64], t: usize, lambda: f64) -> f64 {
    let longest = rewards.len() - t;
    let look = |n: usize| {
        let (mut sum, mut discount) = (0.0, 1.0);
        for i in t..t + n {
            sum += discount * rewards[i];
            discount *= discounts[i];
        }
        sum + discount * values[t + n]
    };
    let weight = |n: usize| match n == longest {
        true => lambda.powi(n as i32 - 1),
        false => (1.0 - lambda) * lambda.powi(n as i32 - 1),
    };
    (1..=longest).map(|n| weight(n) * look(n)).sum()
}

/// V and return of every transition.
fn judged(critic: &ScalarMlp, replay: &Replay<'_>) -> Vec<(f64, f64)> {
    let (dataset, config) = (replay.dataset(), config());
    let mut all = Vec::new();
    for episode in dataset.episodes() {
        let steps = episode.first_step..episode.first_step + episode.len;
        let row = dataset.observations_row(episode.first_step);
        let value = |i: usize| {
            let x = wide(&replay.standardised(row + i..row + i + 1));
            config.value_scale * critic.forward(&x)[0]
        };
        let values: Vec<_> = (0..=episode.len).map(value).collect();
        let rewards = wide(&replay.rewards()[steps.clone()]);
        let discounts = wide(&replay.discounts()[steps]);
        let of = |t| mixed_return(&rewards, &discounts, &values, t, config.lambda);
        all.extend((0..episode.len).map(|t| (values[t], of(t))));
    }
    all
}

fn weights(judged: &[(f64, f64)]) -> Vec<f64> {
    let advantages: Vec<_> = judged.iter().map(|(v, r)| r - v).collect();
    let count = advantages.len() as f64;
    let mean = advantages.iter().sum::<f64>() / count;
    let variance = advantages.iter().map(|a| (a - mean).powi(2)).sum::<f64>() / count;
    let normalised = advantages
        .iter()
        .map(|a| (a - mean) / (variance.sqrt() + 1e-5));
    normalised
        .map(|a| a.exp().min(config().weight_clip))
        .collect()
}

struct Momentum(Vec<f64>);

impl Momentum {
    fn step(&mut self, parameters: &mut [f64], gradient: &[f64], rate: f64) {
        for ((p, v), g) in parameters.iter_mut().zip(&mut self.0).zip(gradient) {
            *v = config().momentum * *v + g;
            *p -= rate * *v;
        }
    }
}

#[test]
fn updates_are_those_of_the_scalar_reference_in_every_parameter() {
    /// What single precision loses in twelve updates.
    const TOLERANCE: f64 = 2e-5;
    let (dataset, config) = (dataset(), config());
    let replay = replay(&dataset, 1);
    for backend in BACKENDS {
        let mut awr = learner(&[1], backend);
        let mut critic = ScalarMlp::member(&awr.critic, 0);
        let mut actor = ScalarMlp::member(&awr.actor, 0);
        let still = |n: &ScalarMlp| Momentum(vec![0.0; n.parameters.len()]);
        let (mut critic_velocity, mut actor_velocity) = (still(&critic), still(&actor));
        let mut labels = Vec::new();
        for step in 0..12 {
            awr.prepare(&[&replay]);
            let batch = replay.batch(Seed::root(3), step, ROWS);
            awr.update(&batch);

            match step % 5 {
                0 => {
                    let judged = judged(&critic, &replay).into_iter();
                    labels = judged.map(|(_, r)| r / config.value_scale).collect();
                }
                3 => labels = weights(&judged(&critic, &replay)),
                _ => {}
            }
            let (s, a) = (wide(&batch.observations), wide(&batch.actions));
            let rows = || {
                let rows = s.chunks(SHAPE.observation).zip(a.chunks(SHAPE.action));
                rows.zip(batch.transitions.iter().map(|&t| labels[t as usize]))
            };
            if step % 5 < 3 {
                let gradient = central_differences(&critic.parameters, |p| {
                    let critic = critic.with(p);
                    let error = |((s, _), y): ((&[f64], _), f64)| critic.forward(s)[0] - y;
                    rows().map(|row| 0.5 * error(row).powi(2)).sum::<f64>() / ROWS as f64
                });
                critic_velocity.step(&mut critic.parameters, &gradient, config.critic_rate);
            } else {
                let gradient = central_differences(&actor.parameters, |p| {
                    let actor = actor.with(p);
                    let loss = |((s, a), weight): ((&[f64], &[f64]), f64)| {
                        let pairs = actor.forward(s).into_iter().zip(a);
                        let squares: f64 = pairs.map(|(m, a)| (a - m).powi(2)).sum();
                        weight * 0.5 * squares / config.std.powi(2)
                    };
                    rows().map(loss).sum::<f64>() / ROWS as f64
                });
                actor_velocity.step(&mut actor.parameters, &gradient, config.actor_rate);
            }
            let close = |name: &str, network: &crate::nn::Mlp, expected: &ScalarMlp| {
                let what = format!("{backend:?}, {name} after update {}", step + 1);
                let actual = flat(&network.parameters.layers(), 0);
                assert_close(&actual, &expected.parameters, TOLERANCE, &what);
            };
            close("critic", &awr.critic, &critic);
            close("actor", &awr.actor, &actor);
        }
    }
}
