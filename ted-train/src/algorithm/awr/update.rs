//! One step of advantage-weighted regression: of V in the first part of an iteration, of the policy in the second.

use burn::tensor::Tensor;

use crate::algorithm::{Batch, Replay};
use crate::nn::lanes::{means, tensor};

use super::{Awr, Sweep, regression_loss, value_loss};

/// The loss of one update of one lane: of the network whose turn it was.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct UpdateMetrics {
    /// Half the mean squared distance of V to its returns, over the square of the value scale.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub critic_loss: Option<f32>,
    /// Advantage-weighted negative log-likelihood.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub policy_loss: Option<f32>,
}

/// What the next update trains, and the first update of that phase.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    Critic { begins: u64 },
    Actor { begins: u64 },
}

impl Awr {
    fn phase(&self) -> Phase {
        let (critic, actor) = (self.config.critic_steps, self.config.actor_steps);
        let at = self.step % (critic + actor);
        let begins = self.step - at;
        if at < critic {
            Phase::Critic { begins }
        } else {
            let begins = begins + critic;
            Phase::Actor { begins }
        }
    }

    /// Looks at the whole dataset of each lane if the next update begins a phase, or if nothing is known of the present one:
    /// to be called before every update.
    pub fn prepare(&mut self, replays: &[&Replay<'_>]) {
        let phase = self.phase();
        let (Phase::Critic { begins } | Phase::Actor { begins }) = phase;
        if self
            .sweep
            .as_ref()
            .is_some_and(|sweep| sweep.begins == begins)
        {
            return;
        }
        let device = self.backend.device();
        let sweep = match phase {
            Phase::Critic { .. } => {
                if self.step == begins {
                    self.begun_with = self.critic.clone();
                }
                let critic = &self.begun_with;
                Sweep::targets(begins, critic, replays, &self.config, &device)
            }
            Phase::Actor { .. } => {
                let critic = &self.critic;
                Sweep::weights(begins, critic, replays, &self.config, &device)
            }
        };
        self.sweep = Some(sweep);
    }

    /// One update on a batch. The metrics are lazy: `Losses::read` fetches them when somebody wants to log.
    ///
    /// # Panics
    /// When [`Self::prepare`] was not called before, with the datasets that the batch is of.
    pub fn update(&mut self, batch: &Batch) -> Losses {
        self.backend.run(|| self.update_here(batch))
    }

    fn update_here(&mut self, batch: &Batch) -> Losses {
        let rows = batch.rewards.len() / self.lanes;
        let (lanes, device) = (self.lanes, self.backend.device());
        let tensor = |data: &[f32]| tensor(data, lanes, rows, &device);
        let sweep = self.sweep.as_ref().expect("prepare comes before update");
        let label = tensor(&sweep.of(&batch.transitions));
        let observation = tensor(&batch.observations);
        let config = &self.config;
        let phase = self.phase();
        self.step += 1;
        match phase {
            Phase::Critic { .. } => {
                let (v, tape) = self.critic.forward_tape(observation);
                let (loss, d_v) = value_loss(v, label);
                let gradients = self.critic.gradients(tape, d_v);
                let (critic, velocity) = (&mut self.critic, &mut self.critic_velocity);
                velocity.step(critic, gradients, config.momentum, config.critic_rate);
                Losses::Critic(loss)
            }
            Phase::Actor { .. } => {
                let action = tensor(&batch.actions);
                let (mean, tape) = self.actor.forward_tape(observation);
                let (loss, d_mean) = regression_loss(mean, action, label, config.std);
                let gradients = self.actor.gradients(tape, d_mean);
                let (actor, velocity) = (&mut self.actor, &mut self.actor_velocity);
                velocity.step(actor, gradients, config.momentum, config.actor_rate);
                Losses::Actor(loss)
            }
        }
    }
}

/// What an update saw, still on the device.
pub enum Losses {
    /// Of V, `[lane, 1, 1]`.
    Critic(Tensor<3>),
    /// Of the policy, `[lane, 1, 1]`.
    Actor(Tensor<3>),
}

impl Losses {
    /// Fetches the numbers of each lane.
    #[must_use]
    pub fn read(self) -> Vec<UpdateMetrics> {
        let (of_critic, loss) = match self {
            Self::Critic(loss) => (true, loss),
            Self::Actor(loss) => (false, loss),
        };
        let lanes = loss.dims()[0];
        let of_lane = |loss| UpdateMetrics {
            critic_loss: of_critic.then_some(loss),
            policy_loss: (!of_critic).then_some(loss),
        };
        means(loss, lanes).into_iter().map(of_lane).collect()
    }
}
