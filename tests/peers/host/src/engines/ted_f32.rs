//! ted-core in f32.

use std::error::Error;

use ted_core::{Dense, Mlp, Normaliser, Output, Policy, Scratch};

use super::Engine;
use crate::blob::Blob;
use crate::network::{ACTION, Network, OBSERVATION};

pub struct TedF32<'n> {
    policy: Policy<'n>,
    scratch: Scratch,
}

impl<'n> TedF32<'n> {
    pub fn new(network: &Network, blob: &'n Blob) -> Result<Self, Box<dyn Error>> {
        let mut arrays = blob.arrays();
        let mut next = || arrays.next().ok_or("the blob is too short");
        let normaliser = Normaliser::new(next()?, next()?)?;
        let mut layers = Vec::new();
        for layer in &network.layers {
            layers.push(Dense::new(layer.inputs, layer.outputs, next()?, next()?)?);
        }
        Ok(Self {
            policy: Policy::new(normaliser, Mlp::new(&layers, Output::Tanh)?)?,
            scratch: Scratch::new(),
        })
    }
}

impl Engine for TedF32<'_> {
    fn name(&self) -> String {
        "ted-core f32".into()
    }

    fn settings(&self) -> &'static str {
        "has no threads; `Policy::act`"
    }

    fn act(
        &mut self,
        obs_raw: &[f32; OBSERVATION],
        action: &mut [f32; ACTION],
    ) -> Result<(), Box<dyn Error>> {
        Ok(self.policy.act(obs_raw, &mut self.scratch, action)?)
    }
}
