//! ted-core in f32.

use std::error::Error;

use ted_core::{Dense, Mlp, Normaliser, Output, Policy, Scratch};

use super::Engine;
use crate::network::{ACTION, Network, OBSERVATION};

pub struct TedF32<'n> {
    policy: Policy<'n>,
    scratch: Scratch,
}

impl<'n> TedF32<'n> {
    pub fn new(network: &'n Network) -> Result<Self, Box<dyn Error>> {
        let layers = network
            .layers
            .iter()
            .map(|layer| Dense::new(layer.inputs, layer.outputs, &layer.weights, &layer.bias))
            .collect::<Result<Vec<_>, _>>()?;
        let normaliser = Normaliser::new(&network.shift, &network.scale)?;
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
