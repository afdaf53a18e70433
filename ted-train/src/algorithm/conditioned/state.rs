//! Saving and restoring a learner, lane by lane and to the bit, and the policy that flies.

use burn::tensor::Tensor;

use crate::checkpoint::{Checkpoint, ForeignCheckpoint, Visit};
use crate::nn::ExportedMlp;
use crate::nn::lanes;

use super::Conditioned;

impl Conditioned {
    /// Everything that the next update of a lane depends on, and what it is flown at: the same whatever lanes are beside it.
    #[must_use]
    pub fn checkpoint(&self, lane: usize, config_digest: [u8; 32]) -> Checkpoint {
        let lanes = [lane, self.lanes()];
        Checkpoint::of_lane(config_digest, self.step, lanes, |visit| {
            self.clone().for_each_tensor(visit)
        })
    }

    /// Puts saved states in the place of this one: a checkpoint of each lane, all after the same update.
    ///
    /// # Errors
    /// When they are not, or one lacks a tensor or has another shape; the learner must not be used then.
    pub fn restore(&mut self, lanes: &[&Checkpoint]) -> Result<(), ForeignCheckpoint> {
        let (count, device) = (self.lanes(), self.backend.device());
        self.step =
            Checkpoint::restore_lanes(lanes, count, &device, |visit| self.for_each_tensor(visit))?;
        Ok(())
    }

    /// The policy of each lane in the controller's layout: `(1 + c haste gain) f0 + c h` at the condition it is flown at, which is
    /// one linear layer on the trunk, `(1 + c haste gain) W0 + c W1` and the same of the biases.
    #[must_use]
    pub fn actors(&self) -> Vec<ExportedMlp> {
        let mut actors = ExportedMlp::members(&self.average);
        let of_lanes = |numbers: &Tensor<3>| lanes::means(numbers.clone(), self.lanes());
        let (advances, gains) = (of_lanes(&self.advance), of_lanes(&self.average_gain));
        for ((actor, advance), gain) in actors.iter_mut().zip(advances).zip(gains) {
            let condition = self.config.aim * f64::from(advance);
            let longer = condition * self.config.haste * f64::from(gain);
            let shares = [1.0 + longer, condition];
            if let Some(last) = actor.layers.last_mut() {
                last.weight = folded(&last.weight, shares);
                last.bias = folded(&last.bias, shares);
            }
        }
        actors
    }

    /// Names every tensor of the state, always in the same order.
    fn for_each_tensor(&mut self, visit: Visit<'_>) -> Result<(), ForeignCheckpoint> {
        self.network.parameters.visit("network", visit)?;
        self.average.parameters.visit("average", visit)?;
        self.adam.visit("adam/network", visit)?;
        visit("gain".to_owned(), &mut self.gain)?;
        visit("average/gain".to_owned(), &mut self.average_gain)?;
        visit("adam/gain/first".to_owned(), &mut self.gain_adam.first)?;
        visit("adam/gain/second".to_owned(), &mut self.gain_adam.second)?;
        visit("advance".to_owned(), &mut self.advance)
    }
}

/// The two halves, each in its share, rounded once.
fn folded(halves: &[f32], shares: [f64; 2]) -> Vec<f32> {
    let (average, other) = halves.split_at(halves.len() / 2);
    let pairs = average.iter().zip(other);
    pairs
        .map(|(&a, &h)| (shares[0] * f64::from(a) + shares[1] * f64::from(h)) as f32)
        .collect()
}
