//! The engines, each behind one method: a raw observation in, an action out.

mod burn_flex;
mod candle_cpu;
mod onnxruntime;
mod ted_f32;
mod ted_integer;
mod tract;

use std::error::Error;

use crate::blob::Blob;
use crate::network::{ACTION, Network, OBSERVATION};
use crate::onnx;
use crate::quantise::Quantised;

/// An inference engine that holds the policy, ready to act.
pub trait Engine {
    /// Who it is, with its version.
    fn name(&self) -> String;

    /// What it was told to do: threads, optimisation.
    fn settings(&self) -> &'static str;

    /// How far an action may be from the exact one.
    fn tolerance(&self) -> f64 {
        1e-5
    }

    /// Computes one action.
    fn act(
        &mut self,
        obs_raw: &[f32; OBSERVATION],
        action: &mut [f32; ACTION],
    ) -> Result<(), Box<dyn Error>>;
}

/// All of them: ted-core in f32 first, ted-core in integers second, then the peers.
pub fn all<'n>(
    network: &'n Network,
    blob: &'n Blob,
    quantised: &'n Quantised,
    library: &str,
) -> Result<Vec<Box<dyn Engine + 'n>>, Box<dyn Error>> {
    let model = onnx::model(network);
    Ok(vec![
        Box::new(ted_f32::TedF32::new(network, blob)?),
        Box::new(ted_integer::TedInteger::new(network, quantised)?),
        Box::new(onnxruntime::OnnxRuntime::new(network, &model, library)?),
        Box::new(tract::Tract::new(network, &model)?),
        Box::new(candle_cpu::CandleCpu::new(network)?),
        Box::new(burn_flex::BurnFlex::new(network)),
    ])
}
