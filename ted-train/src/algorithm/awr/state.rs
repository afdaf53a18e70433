//! Saving and restoring a learner, lane by lane and to the bit. What was seen of the dataset is not saved but seen again.

use burn::tensor::Tensor;

use crate::nn::ExportedMlp;
use crate::run::{Checkpoint, ForeignCheckpoint};

use super::Awr;

impl Awr {
    /// Everything that the next update of a lane depends on: the same whatever lanes are beside it.
    #[must_use]
    pub fn checkpoint(&self, lane: usize, config_digest: [u8; 32]) -> Checkpoint {
        let mut checkpoint = Checkpoint {
            config_digest,
            step: self.step,
            tensors: Vec::new(),
        };
        let (lanes, mut copy) = (self.lanes(), self.clone());
        copy.for_each_tensor(|name, tensor| {
            checkpoint.push(name, tensor, lane, lanes);
            Ok::<(), ForeignCheckpoint>(())
        })
        .unwrap_or_else(|error| unreachable!("pushing cannot fail: {error}"));
        checkpoint
    }

    /// Puts saved states in the place of this one: a checkpoint of each lane, all after the same update.
    ///
    /// # Errors
    /// When they are not, or one lacks a tensor or has another shape; the learner must not be used then.
    pub fn restore(&mut self, lanes: &[&Checkpoint]) -> Result<(), ForeignCheckpoint> {
        let step = Checkpoint::common_step(lanes, self.lanes())?;
        let device = self.backend.device();
        self.for_each_tensor(|name, tensor| {
            *tensor = Checkpoint::fetch(lanes, &name, tensor, &device)?;
            Ok(())
        })?;
        self.step = step;
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
    fn for_each_tensor<E>(
        &mut self,
        mut visit: impl FnMut(String, &mut Tensor<3>) -> Result<(), E>,
    ) -> Result<(), E> {
        let visit = &mut visit;
        self.critic.parameters.visit("critic", visit)?;
        self.begun_with.parameters.visit("begun_with", visit)?;
        self.actor.parameters.visit("actor", visit)?;
        self.critic_velocity.visit("velocity/critic", visit)?;
        self.actor_velocity.visit("velocity/actor", visit)
    }
}
