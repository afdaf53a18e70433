//! Saving and restoring a learner, lane by lane and to the bit, and the part of it that flies.

use crate::checkpoint::{Checkpoint, ForeignCheckpoint, Visit};
use crate::nn::{Activation, ExportedMlp};

use super::Atac;

impl Atac {
    /// Everything that the next update of a lane depends on, but for the seed of its noise: the same whatever lanes are beside it.
    #[must_use]
    pub fn checkpoint(&self, lane: usize, config_digest: [u8; 32]) -> Checkpoint {
        let lanes = [lane, self.lanes()];
        Checkpoint::of_lane(config_digest, self.step, lanes, |visit| {
            self.clone().for_each_tensor(visit)
        })
    }

    /// Puts saved states in the place of this one, which has the same seeds: a checkpoint of each lane, all after the same update.
    ///
    /// # Errors
    /// When they are not, or one lacks a tensor or has another shape; the learner must not be used then.
    pub fn restore(&mut self, lanes: &[&Checkpoint]) -> Result<(), ForeignCheckpoint> {
        let (count, device) = (self.lanes(), self.backend.device());
        self.step =
            Checkpoint::restore_lanes(lanes, count, &device, |visit| self.for_each_tensor(visit))?;
        Ok(())
    }

    /// The policy of each lane in the controller's layout: tanh of the mean. The mean is the first half of the network's last
    /// layer, so leaving out the other half is exact.
    #[must_use]
    pub fn actors(&self) -> Vec<ExportedMlp> {
        let mut actors = ExportedMlp::members(&self.policy);
        for actor in &mut actors {
            actor.output = Activation::Tanh;
            if let Some(last) = actor.layers.last_mut() {
                last.weight.truncate(last.weight.len() / 2);
                last.bias.truncate(last.bias.len() / 2);
            }
        }
        actors
    }

    /// Names every tensor of the state, always in the same order.
    fn for_each_tensor(&mut self, visit: Visit<'_>) -> Result<(), ForeignCheckpoint> {
        self.policy.parameters.visit("policy", visit)?;
        self.policy_adam.visit("adam/policy", visit)?;
        for (h, critic) in self.critics.iter_mut().enumerate() {
            critic.parameters.visit(&format!("critic/{h}"), visit)?;
        }
        for (h, target) in self.targets.iter_mut().enumerate() {
            target.parameters.visit(&format!("target/{h}"), visit)?;
        }
        for (h, adam) in self.critic_adams.iter_mut().enumerate() {
            adam.visit(&format!("adam/critic/{h}"), visit)?;
        }
        let adam = &mut self.log_alpha_adam;
        visit("log_alpha".to_owned(), &mut self.log_alpha)?;
        visit("adam/log_alpha/first".to_owned(), &mut adam.first)?;
        visit("adam/log_alpha/second".to_owned(), &mut adam.second)
    }
}
