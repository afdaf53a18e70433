//! One step of behaviour cloning.

use burn::tensor::Tensor;

use crate::algorithm::Batch;
use crate::nn::lanes::{means, tensor};

use super::{Bc, imitation_loss};

/// Losses of one update of one lane.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct UpdateMetrics {
    /// Mean squared distance of the policy's actions to the data's.
    pub policy_loss: f32,
}

impl Bc {
    /// One update on a batch, of which it reads observations and actions. The metrics are lazy: `Losses::read` fetches them
    /// when somebody wants to log.
    pub fn update(&mut self, batch: &Batch) -> Losses {
        self.backend.run(|| self.update_here(batch))
    }

    fn update_here(&mut self, batch: &Batch) -> Losses {
        let rows = batch.rewards.len() / self.lanes;
        let device = self.backend.device();
        let observation = tensor(&batch.observations, self.lanes, rows, &device);
        let action = tensor(&batch.actions, self.lanes, rows, &device);
        self.step += 1;

        let (policy, tape) = self.policy.forward_tape(observation);
        let (policy_loss, d_policy) = imitation_loss(policy, action);
        let gradients = self.policy.gradients(tape, d_policy);
        let (rate, adam) = (self.config.learning_rate, self.config.adam);
        adam.step(&mut self.policy, &mut self.adam, gradients, rate, self.step);
        Losses { policy_loss }
    }
}

/// What an update saw, still on the device.
pub struct Losses {
    policy_loss: Tensor<3>,
}

impl Losses {
    /// Fetches the numbers of each lane.
    #[must_use]
    pub fn read(self) -> Vec<UpdateMetrics> {
        let lanes = self.policy_loss.dims()[0];
        let losses = means(self.policy_loss, lanes).into_iter();
        losses
            .map(|policy_loss| UpdateMetrics { policy_loss })
            .collect()
    }
}
