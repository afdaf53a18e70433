//! Saving and restoring the learner, to the bit.

use crate::checkpoint::{Checkpoint, ForeignCheckpoint};

use super::Oppo;

impl Oppo {
    /// Everything that the next update depends on, besides the configuration, the dataset and the answers.
    #[must_use]
    pub fn checkpoint(&self) -> Checkpoint {
        let mut checkpoint = Checkpoint {
            step: self.step,
            ..Checkpoint::default()
        };
        let mut own = self.clone();
        let to = &mut checkpoint;
        self.encoder_adam.save("encoder", own.encoder.tensors(), to);
        self.policy_adam.save("policy", own.policy.tensors(), to);
        self.latent_adam.save("latent", vec![&mut own.latent], to);
        checkpoint
    }

    /// Puts a saved state in the place of this one.
    ///
    /// # Errors
    /// When the checkpoint lacks a tensor or has another shape; the learner must not be used then.
    pub fn restore(&mut self, from: &Checkpoint) -> Result<(), ForeignCheckpoint> {
        let (encoder, policy) = (self.encoder.tensors(), self.policy.tensors());
        self.encoder_adam.restore("encoder", encoder, from)?;
        self.policy_adam.restore("policy", policy, from)?;
        self.latent_adam
            .restore("latent", vec![&mut self.latent], from)?;
        self.step = from.step;
        // The policy learns in the updates 0, 2, 4 and so on, the encoder twice in these.
        let even = from.step.div_ceil(2);
        self.steps = [from.step + even, even];
        Ok(())
    }
}
