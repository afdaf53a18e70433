//! tract, from the ONNX model.

use std::error::Error;

use tract_onnx::prelude::*;

use super::Engine;
use crate::network::{ACTION, Network, OBSERVATION};

pub struct Tract<'n> {
    network: &'n Network,
    state: TypedSimpleState,
}

impl<'n> Tract<'n> {
    pub fn new(network: &'n Network, mut model: &[u8]) -> Result<Self, Box<dyn Error>> {
        let plan = tract_onnx::onnx()
            .model_for_read(&mut model)?
            .into_optimized()?
            .into_runnable()?;
        Ok(Self {
            network,
            state: plan.spawn()?,
        })
    }
}

impl Engine for Tract<'_> {
    fn name(&self) -> String {
        "tract-onnx 0.23.9".into()
    }

    fn settings(&self) -> &'static str {
        "single-threaded executor (its default); `into_optimized`, one state kept between runs"
    }

    fn act(
        &mut self,
        obs_raw: &[f32; OBSERVATION],
        action: &mut [f32; ACTION],
    ) -> Result<(), Box<dyn Error>> {
        let mut input = Tensor::zero::<f32>(&[1, OBSERVATION])?;
        self.network
            .standardise(obs_raw, input.try_as_plain_ram_mut()?.as_slice_mut()?);
        let output = self.state.run(tvec!(input.into()))?;
        action.copy_from_slice(output[0].try_as_plain_ram()?.as_slice::<f32>()?);
        Ok(())
    }
}
