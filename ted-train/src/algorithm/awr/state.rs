//! Saving and restoring a learner, lane by lane and to the bit. What was seen of the dataset is not saved but seen again.

use crate::checkpoint::{Checkpoint, ForeignCheckpoint, Visit};
use crate::nn::ExportedMlp;

use super::Awr;

impl Awr {
    /// Everything that the next update of a lane depends on: the same whatever lanes are beside it.
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
        // It follows from what was restored, and from the dataset.
        self.sweep = None;
        Ok(())
    }

    /// The policy of each lane in the controller's layout.
    #[must_use]
    pub fn actors(&self) -> Vec<ExportedMlp> {
        ExportedMlp::members(&self.actor)
    }

    /// Names every tensor of the state, always in the same order.
    fn for_each_tensor(&mut self, visit: Visit<'_>) -> Result<(), ForeignCheckpoint> {
        self.critic.parameters.visit("critic", visit)?;
        self.begun_with.parameters.visit("begun_with", visit)?;
        self.actor.parameters.visit("actor", visit)?;
        self.critic_velocity.visit("velocity/critic", visit)?;
        self.actor_velocity.visit("velocity/actor", visit)
    }
}
