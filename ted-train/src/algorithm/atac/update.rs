//! One step of adversarially trained actor critic, in the original's order: critics, projection, targets, alpha, policy.

use burn::tensor::Tensor;

use crate::algorithm::Batch;
use crate::nn::lanes::{means, tensor};

use super::gaussian::Sample;
use super::{Atac, Gaussian, Shares, bellman_loss};

/// Losses and means of one update of one lane.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct UpdateMetrics {
    /// What the critics minimise, summed over both.
    pub critic_loss: f32,
    /// What the policy minimises.
    pub policy_loss: f32,
    /// Mean Q(s, a) of both critics over the batch.
    pub value: f32,
    /// The policy's entropy, mean over action coordinates.
    pub entropy: f32,
    /// Logarithm of the entropy's weight.
    pub log_alpha: f32,
}

/// A batch on the device: `[lane, batch, width]`.
struct Transitions {
    observation: Tensor<3>,
    next_observation: Tensor<3>,
    action: Tensor<3>,
    reward: Tensor<3>,
    discount: Tensor<3>,
}

impl Atac {
    /// One update on a batch. The metrics are lazy: `Losses::read` fetches them when somebody wants to log.
    pub fn update(&mut self, batch: &Batch) -> Losses {
        self.backend.run(|| self.update_here(batch))
    }

    fn update_here(&mut self, batch: &Batch) -> Losses {
        let rows = batch.rewards.len() / self.lanes();
        let (lanes, device) = (self.lanes(), self.backend.device());
        let tensor = |data: &[f32]| tensor(data, lanes, rows, &device);
        let seen = Transitions {
            observation: tensor(&batch.observations),
            next_observation: tensor(&batch.next_observations),
            action: tensor(&batch.actions),
            reward: tensor(&batch.rewards),
            discount: tensor(&batch.discounts),
        };
        if self.step == self.config.warm_start {
            self.end_warm_start();
        }
        let warm = self.step < self.config.warm_start;
        let (fast, std) = (self.config.fast_rate, self.config.std);
        let adam = self.config.adam;
        let [noise, next_noise] = self.noise(rows, seen.action.dims()[2]);
        self.step += 1;
        let step = if warm {
            self.step
        } else {
            self.step - self.config.warm_start
        };

        // What the policy would do here and there, as it is before the update.
        let (output, policy_tape) = self.policy.forward_tape(seen.observation.clone());
        let policy = Gaussian::new(output, std);
        let here = policy.sample(noise);
        let next = self.policy.forward(seen.next_observation.clone());
        let next = Gaussian::new(next, std).sample(next_noise);

        // Critics: the Bellman error and, after the warm start, relative pessimism.
        if warm {
            self.average_targets();
        }
        let pessimism = (!warm).then_some(&here);
        let (critic_loss, value) = self.critic_step(&seen, &next, pessimism, step);
        if !warm {
            self.critics
                .iter_mut()
                .for_each(|critic| critic.project(self.config.norm_limit));
            self.average_targets();
        }

        // Alpha: up while the policy's entropy is below its target.
        let (entropy, d_entropy) = here.entropy();
        let target_entropy = -(seen.action.dims()[2] as f64);
        let d_log_alpha = entropy.clone().sub_scalar(target_entropy);
        let (log_alpha, moments) = (&mut self.log_alpha, &mut self.log_alpha_adam);
        adam.tensor(log_alpha, moments, d_log_alpha, fast, step);
        let alpha = self.log_alpha.clone().exp();

        // Policy: towards the data's actions at first, then up the critic.
        let (loss, d_output, rate) = if warm {
            let (loss, d_output) = policy.negative_log_likelihood(seen.action);
            (loss, d_output, fast)
        } else {
            let (loss, d_output) = self.climb(seen.observation, &here);
            (loss, d_output, self.config.slow_rate)
        };
        let shares = Shares::of_lanes(alpha);
        let policy_loss = shares.loss.clone() * loss - shares.penalty.clone() * entropy.clone();
        let d_output = shares.loss * d_output + shares.penalty * d_entropy;
        let gradients = self.policy.gradients(policy_tape, d_output);
        let (policy, moments) = (&mut self.policy, &mut self.policy_adam);
        adam.step(policy, moments, gradients, rate, step);

        Losses {
            critic_loss,
            policy_loss,
            value,
            entropy,
            log_alpha: self.log_alpha.clone(),
        }
    }

    /// One step of both critics; `here` are the policy's own actions, if they are to be judged. Returns the loss `[lane, 1, 1]`
    /// and the mean of Q(s, a).
    fn critic_step(
        &mut self,
        seen: &Transitions,
        next: &Sample,
        here: Option<&Sample>,
        step: u64,
    ) -> (Tensor<3>, Tensor<3>) {
        let rows = seen.reward.dims()[1];
        let pair = |observation: &Tensor<3>, action: &Tensor<3>| {
            Tensor::cat(vec![observation.clone(), action.clone()], 2)
        };
        let pair_next = pair(&seen.next_observation, &next.action);
        let [first, second] = self
            .targets
            .each_ref()
            .map(|target| target.forward(pair_next.clone()));
        let y = seen.reward.clone() + seen.discount.clone() * first.min_pair(second);

        let mut pairs = vec![pair(&seen.observation, &seen.action), pair_next];
        pairs.extend(here.map(|here| pair(&seen.observation, &here.action)));
        let pairs = Tensor::cat(pairs, 1);
        let shares = match here {
            // An expectile loss at one half, which is what the warm start's is, is half a square.
            None => Shares {
                loss: 0.0,
                penalty: 0.5,
            },
            Some(_) => Shares::of(self.config.beta),
        };
        let (rate, adam) = (self.config.fast_rate, self.config.adam);
        let step_of_one = |(critic, moments): (&mut _, &mut _)| {
            let critic: &mut crate::nn::Mlp = critic;
            let (q, tape) = critic.forward_tape(pairs.clone());
            let part = |at: usize| q.clone().narrow(1, at * rows, rows);
            let (reward, discount) = (seen.reward.clone(), seen.discount.clone());
            let (bellman, d_q, d_next) =
                bellman_loss(part(0), part(1), y.clone(), reward, discount);
            let mut loss = bellman.mul_scalar(shares.penalty);
            let mut d_q = d_q.mul_scalar(shares.penalty);
            let mut d_pairs = vec![d_next.mul_scalar(shares.penalty)];
            if here.is_some() {
                let each = shares.loss / rows as f64;
                loss = loss + (part(2) - part(0)).mean_dim(1).mul_scalar(shares.loss);
                d_q = d_q.sub_scalar(each);
                d_pairs.push(d_q.full_like(each));
            }
            d_pairs.insert(0, d_q);
            let gradients = critic.gradients(tape, Tensor::cat(d_pairs, 1));
            adam.step(critic, moments, gradients, rate, step);
            (loss, part(0).mean_dim(1))
        };
        let [first, second] = &mut self.critics;
        let [first_adam, second_adam] = &mut self.critic_adams;
        let (first, second) = self.backend.join(
            || step_of_one((first, first_adam)),
            || step_of_one((second, second_adam)),
        );
        (first.0 + second.0, (first.1 + second.1).div_scalar(2.0))
    }

    /// `-E[ Q(s, pi(s)) ]` of the last critic, `[lane, 1, 1]`, and its gradient in the policy's output.
    fn climb(&self, observation: Tensor<3>, here: &Sample) -> (Tensor<3>, Tensor<3>) {
        let [_, rows, observations] = observation.dims();
        let [_, critic] = &self.critics;
        let pair = Tensor::cat(vec![observation, here.action.clone()], 2);
        let (q, tape) = critic.forward_tape(pair);
        let d_q = q.full_like(-1.0 / rows as f64);
        let d_pair = critic.input_gradient(tape, d_q);
        let actions = here.action.dims()[2];
        let d_action = d_pair.narrow(2, observations, actions);
        (q.mean_dim(1).neg(), here.through(d_action))
    }

    fn average_targets(&mut self) {
        for (target, critic) in self.targets.iter_mut().zip(&self.critics) {
            target.polyak(critic, self.config.target_rate);
        }
    }
}

/// What an update saw, still on the device.
pub struct Losses {
    critic_loss: Tensor<3>,
    policy_loss: Tensor<3>,
    value: Tensor<3>,
    entropy: Tensor<3>,
    log_alpha: Tensor<3>,
}

impl Losses {
    /// Fetches the numbers of each lane.
    #[must_use]
    pub fn read(self) -> Vec<UpdateMetrics> {
        let lanes = self.log_alpha.dims()[0];
        let critic_loss = means(self.critic_loss, lanes);
        let policy_loss = means(self.policy_loss, lanes);
        let value = means(self.value, lanes);
        let entropy = means(self.entropy, lanes);
        let log_alpha = means(self.log_alpha, lanes);
        let of_lane = |lane| UpdateMetrics {
            critic_loss: critic_loss[lane],
            policy_loss: policy_loss[lane],
            value: value[lane],
            entropy: entropy[lane],
            log_alpha: log_alpha[lane],
        };
        (0..lanes).map(of_lane).collect()
    }
}
