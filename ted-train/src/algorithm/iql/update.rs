//! One step of implicit Q-learning, in the original's order: V, policy, Q, target.

use burn::tensor::Tensor;

use crate::algorithm::Batch;
use crate::nn::lanes::{means, tensor};

use super::networks::{HEADS, Iql};
use super::{critic_loss, expectile_loss, policy_loss};

/// Losses and means of one update of one lane.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct UpdateMetrics {
    /// Expectile loss of V.
    pub value_loss: f32,
    /// Advantage-weighted negative log-likelihood.
    pub policy_loss: f32,
    /// Mean squared Bellman error of one critic head.
    pub critic_loss: f32,
    /// Mean V(s) over the batch.
    pub value: f32,
    /// Mean advantage over the batch.
    pub advantage: f32,
    /// The actor's step size in the next update.
    pub actor_rate: f64,
}

impl Iql {
    /// One update on a batch. The metrics are lazy: `Losses::read` fetches them when somebody wants to log.
    ///
    /// On a processor it runs on the threads of the pool it is called from, or else of the global one; in a pool of one thread
    /// it wakes nobody.
    pub fn update(&mut self, batch: &Batch) -> Losses {
        self.backend.run(|| self.update_here(batch))
    }

    fn update_here(&mut self, batch: &Batch) -> Losses {
        let (lanes, backend) = (self.lanes(), self.backend);
        let device = backend.device();
        let rows = batch.rewards.len() / lanes;
        let tensor = |data: &[f32]| tensor(data, lanes, rows, &device);
        let observation = tensor(&batch.observations);
        let next_observation = tensor(&batch.next_observations);
        let action = tensor(&batch.actions);
        let reward = tensor(&batch.rewards);
        let discount = tensor(&batch.discounts);
        let pair = for_each_head(Tensor::cat(vec![observation.clone(), action.clone()], 2));
        let (rate, actor_rate) = (self.config.learning_rate, self.config.actor_rate(self.step));
        let adam = self.config.adam;
        self.step += 1;
        let step = self.step;

        // What this step's V decides nothing about, side by side.
        let (of_critics, of_observation) = backend.join(
            || {
                backend.join(
                    || minimum_of_heads(self.target.forward(pair.clone())),
                    || self.critic.forward_tape(pair.clone()),
                )
            },
            || {
                backend.join(
                    || self.value.forward_tape(observation.clone()),
                    || self.actor.forward_tape(observation.clone()),
                )
            },
        );
        let (q_target, (q, critic_tape)) = of_critics;
        let ((v, value_tape), (mean, actor_tape)) = of_observation;

        // V, towards the expectile of the target critics' minimum.
        let (value_loss, d_v) = expectile_loss(q_target.clone(), v, self.config.tau);
        let gradients = self.value.gradients(value_tape, d_v);
        adam.step(&mut self.value, &mut self.value_adam, gradients, rate, step);

        // From here on V is the new one, in both places.
        let both = self
            .value
            .forward(Tensor::cat(vec![observation, next_observation], 1));
        let v = both.clone().narrow(1, 0, rows);
        let v_next = both.narrow(1, rows, rows);
        let advantage = q_target - v.clone();

        let (policy_loss, critic_loss) = backend.join(
            // Policy, by advantage-weighted regression onto the data's actions.
            || {
                let (loss, d_mean, d_log_std) = policy_loss(
                    mean,
                    self.log_std.clone(),
                    action,
                    advantage.clone(),
                    &self.config,
                );
                let gradients = self.actor.gradients(actor_tape, d_mean);
                let (actor, moments) = (&mut self.actor, &mut self.actor_adam);
                adam.step(actor, moments, gradients, actor_rate, step);
                let (log_std, moments) = (&mut self.log_std, &mut self.log_std_adam);
                adam.tensor(log_std, moments, d_log_std, actor_rate, step);
                loss
            },
            // Q, towards the Bellman target with each transition's own discount; and the target critics after it.
            || {
                let y = for_each_head(reward + discount * v_next);
                let (loss, d_q) = critic_loss(q, y);
                let gradients = self.critic.gradients(critic_tape, d_q);
                let (critic, moments) = (&mut self.critic, &mut self.critic_adam);
                adam.step(critic, moments, gradients, rate, step);
                self.target.polyak(&self.critic, self.config.target_rate);
                loss
            },
        );
        Losses {
            value_loss,
            policy_loss,
            critic_loss,
            value: v,
            advantage,
            actor_rate: self.config.actor_rate(step),
        }
    }
}

/// What an update saw, still on the device.
pub struct Losses {
    value_loss: Tensor<3>,
    policy_loss: Tensor<3>,
    critic_loss: Tensor<3>,
    value: Tensor<3>,
    advantage: Tensor<3>,
    actor_rate: f64,
}

impl Losses {
    /// Fetches the numbers of each lane.
    #[must_use]
    pub fn read(self) -> Vec<UpdateMetrics> {
        let lanes = self.value.dims()[0];
        let value_loss = means(self.value_loss, lanes);
        let policy_loss = means(self.policy_loss, lanes);
        let critic_loss = means(self.critic_loss, lanes);
        let value = means(self.value, lanes);
        let advantage = means(self.advantage, lanes);
        let of_lane = |lane| UpdateMetrics {
            value_loss: value_loss[lane],
            policy_loss: policy_loss[lane],
            critic_loss: critic_loss[lane],
            value: value[lane],
            advantage: advantage[lane],
            actor_rate: self.actor_rate,
        };
        (0..lanes).map(of_lane).collect()
    }
}

/// `[lane, batch, w] -> [lane * heads, batch, w]`, or unchanged for one lane, which broadcasts.
fn for_each_head(x: Tensor<3>) -> Tensor<3> {
    let [lanes, batch, width] = x.dims();
    if lanes == 1 {
        return x;
    }
    x.unsqueeze_dim::<4>(1)
        .expand([lanes, HEADS, batch, width])
        .reshape([lanes * HEADS, batch, width])
}

/// `[lane * heads, batch, 1] -> [lane, batch, 1]`.
fn minimum_of_heads(q: Tensor<3>) -> Tensor<3> {
    let [members, batch, _] = q.dims();
    let q = q.reshape([members / HEADS, HEADS, batch]);
    let (first, second) = (q.clone().narrow(1, 0, 1), q.narrow(1, 1, 1));
    first.min_pair(second).swap_dims(1, 2)
}
