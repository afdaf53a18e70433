//! Saving and restoring a learner, lane by lane and to the bit.

use burn::tensor::Tensor;

use crate::nn::{AdamState, ExportedMlp, Mlp};
use crate::run::{Checkpoint, ForeignCheckpoint};

use super::Iql;

impl Iql {
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
        Ok(())
    }

    /// The actor of each lane in the controller's layout.
    #[must_use]
    pub fn actors(&self) -> Vec<ExportedMlp> {
        ExportedMlp::members(&self.actor)
    }

    /// Names every tensor of the state, always in the same order.
    fn for_each_tensor<E>(
        &mut self,
        mut visit: impl FnMut(String, &mut Tensor<3>) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut network = |name: &str, network: &mut Mlp| {
            let mut layers = network.parameters.layers();
            for (i, layer) in layers.iter_mut().enumerate() {
                visit(format!("{name}/{i}/weight"), &mut layer.weight)?;
                visit(format!("{name}/{i}/bias"), &mut layer.bias)?;
            }
            network.parameters.set_layers(layers);
            Ok(())
        };
        network("value", &mut self.value)?;
        network("actor", &mut self.actor)?;
        network("critic", &mut self.critic)?;
        network("target", &mut self.target)?;
        visit("log_std".to_owned(), &mut self.log_std)?;
        visit(
            "adam/log_std/first".to_owned(),
            &mut self.log_std_adam.first,
        )?;
        visit(
            "adam/log_std/second".to_owned(),
            &mut self.log_std_adam.second,
        )?;
        let mut moments = |name: &str, state: &mut AdamState| {
            let (mut firsts, mut seconds) = (state.first.layers(), state.second.layers());
            for (i, (first, second)) in firsts.iter_mut().zip(&mut seconds).enumerate() {
                visit(format!("adam/{name}/{i}/weight/first"), &mut first.weight)?;
                visit(format!("adam/{name}/{i}/weight/second"), &mut second.weight)?;
                visit(format!("adam/{name}/{i}/bias/first"), &mut first.bias)?;
                visit(format!("adam/{name}/{i}/bias/second"), &mut second.bias)?;
            }
            state.first.set_layers(firsts);
            state.second.set_layers(seconds);
            Ok(())
        };
        moments("value", &mut self.value_adam)?;
        moments("actor", &mut self.actor_adam)?;
        moments("critic", &mut self.critic_adam)
    }
}
