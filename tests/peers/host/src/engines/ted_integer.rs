//! ted-core in integers.

use std::error::Error;

use ted_core::integer::{IntegerMlp, IntegerPolicy, IntegerScratch};
use ted_core::quantised::QuantisedPolicy;
use ted_core::{Normaliser, Output};

use super::Engine;
use crate::network::{ACTION, Network, OBSERVATION};
use crate::quantise::Quantised;

pub struct TedInteger<'n> {
    policy: QuantisedPolicy<'n>,
    scratch: IntegerScratch,
}

impl<'n> TedInteger<'n> {
    pub fn new(network: &'n Network, quantised: &'n Quantised) -> Result<Self, Box<dyn Error>> {
        let mlp = IntegerMlp::new(&quantised.views()?, Output::Tanh)?;
        let integer = IntegerPolicy::new(
            quantised.input_fraction_bits,
            quantised.output_fraction_bits,
            mlp,
        )?;
        let normaliser = Normaliser::new(&network.shift, &network.scale)?;
        Ok(Self {
            policy: QuantisedPolicy::new(normaliser, integer)?,
            scratch: IntegerScratch::new(),
        })
    }
}

impl Engine for TedInteger<'_> {
    fn name(&self) -> String {
        "ted-core integer".into()
    }

    fn settings(&self) -> &'static str {
        "has no threads; `QuantisedPolicy::act`: 8-bit weights, 16-bit activations"
    }

    /// What 8 bits of a weight cost, not what the arithmetic does: that is exact.
    fn tolerance(&self) -> f64 {
        0.03
    }

    fn act(
        &mut self,
        obs_raw: &[f32; OBSERVATION],
        action: &mut [f32; ACTION],
    ) -> Result<(), Box<dyn Error>> {
        Ok(self.policy.act(obs_raw, &mut self.scratch, action)?)
    }
}
