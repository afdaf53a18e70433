//! Saving and restoring a learner, lane by lane and to the bit, and the policy that flies.

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

    /// The policy of each lane in the controller's layout: `f0 + c f1` at the condition it is flown at, which is one linear layer
    /// on the trunk, `W0 + c W1` and `b0 + c b1`.
    #[must_use]
    pub fn actors(&self) -> Vec<ExportedMlp> {
        let mut actors = ExportedMlp::members(&self.average);
        let advances = lanes::means(self.advance.clone(), self.lanes());
        for (actor, advance) in actors.iter_mut().zip(advances) {
            let condition = self.config.aim * f64::from(advance);
            if let Some(last) = actor.layers.last_mut() {
                last.weight = folded(&last.weight, condition);
                last.bias = folded(&last.bias, condition);
            }
        }
        actors
    }

    /// Names every tensor of the state, always in the same order.
    fn for_each_tensor(&mut self, visit: Visit<'_>) -> Result<(), ForeignCheckpoint> {
        self.network.parameters.visit("network", visit)?;
        self.average.parameters.visit("average", visit)?;
        self.adam.visit("adam/network", visit)?;
        visit("advance".to_owned(), &mut self.advance)
    }
}

/// The first half plus `condition` times the second one, rounded once.
fn folded(halves: &[f32], condition: f64) -> Vec<f32> {
    let (average, slope) = halves.split_at(halves.len() / 2);
    let pairs = average.iter().zip(slope);
    pairs
        .map(|(&a, &s)| (f64::from(a) + condition * f64::from(s)) as f32)
        .collect()
}
