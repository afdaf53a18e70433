//! One step of conditioned behaviour cloning.

use burn::tensor::Tensor;

use crate::algorithm::Batch;
use crate::nn::average_share;
use crate::nn::lanes::{means, tensor};

use super::Conditioned;
use super::losses::{ConditionedLoss, conditioned_loss};

/// The gain is one number that all transitions speak about, and is to be there before the network learns what it could have said.
pub(super) const GAIN_RATE: f64 = 10.0;

/// Losses of one update of one lane.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct UpdateMetrics {
    /// Mean squared distance of the policy's actions, each at its episode's condition, to the data's.
    pub policy_loss: f32,
    /// The step size in the next update.
    pub policy_rate: f64,
}

impl Conditioned {
    /// One update on a batch, of which it reads observations, actions and conditions. The metrics are lazy: `Losses::read`
    /// fetches them when somebody wants to log.
    pub fn update(&mut self, batch: &Batch) -> Losses {
        self.backend.run(|| self.update_here(batch))
    }

    fn update_here(&mut self, batch: &Batch) -> Losses {
        let lanes = self.lanes();
        let rows = batch.conditions.len() / lanes;
        let device = self.backend.device();
        let tensor = |data: &[f32]| tensor(data, lanes, rows, &device);
        let observation = tensor(&batch.observations);
        let action = tensor(&batch.actions);
        let condition = tensor(&batch.conditions);
        let (rate, adam) = (self.config.rate(self.step), self.config.adam);
        self.step += 1;

        let (heads, tape) = self.network.forward_tape(observation);
        let ConditionedLoss {
            loss: policy_loss,
            d_heads,
            d_gain,
        } = conditioned_loss(heads, self.gain.clone(), condition, action);
        let gradients = self.network.gradients(tape, d_heads);
        self.network.shrink(rate * self.config.weight_decay);
        adam.step(
            &mut self.network,
            &mut self.adam,
            gradients,
            rate,
            self.step,
        );
        adam.tensor(
            &mut self.gain,
            &mut self.gain_adam,
            d_gain,
            rate * GAIN_RATE,
            self.step,
        );

        let share = average_share(self.config.average_rate, self.step);
        self.average.polyak(&self.network, share);
        let moved = self.gain.clone() - self.average_gain.clone();
        self.average_gain = self.average_gain.clone() + moved.mul_scalar(share);
        Losses {
            policy_loss,
            policy_rate: self.config.rate(self.step),
        }
    }
}

/// What an update saw, still on the device.
pub struct Losses {
    policy_loss: Tensor<3>,
    policy_rate: f64,
}

impl Losses {
    /// Fetches the numbers of each lane.
    #[must_use]
    pub fn read(self) -> Vec<UpdateMetrics> {
        let lanes = self.policy_loss.dims()[0];
        let losses = means(self.policy_loss, lanes).into_iter();
        let of_lane = |policy_loss| UpdateMetrics {
            policy_loss,
            policy_rate: self.policy_rate,
        };
        losses.map(of_lane).collect()
    }
}
