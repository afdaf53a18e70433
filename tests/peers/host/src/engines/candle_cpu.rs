//! candle on the CPU.

use std::error::Error;

use candle_core::{Device, Tensor};
use candle_nn::{Linear, Module};

use super::Engine;
use crate::network::{ACTION, Network, OBSERVATION};

pub struct CandleCpu<'n> {
    network: &'n Network,
    layers: Vec<Linear>,
}

impl<'n> CandleCpu<'n> {
    pub fn new(network: &'n Network) -> Result<Self, Box<dyn Error>> {
        let mut layers = Vec::new();
        for layer in &network.layers {
            let sides = (layer.outputs, layer.inputs);
            let weights = Tensor::from_slice(&layer.weights, sides, &Device::Cpu)?;
            let bias = Tensor::from_slice(&layer.bias, layer.outputs, &Device::Cpu)?;
            layers.push(Linear::new(weights, Some(bias)));
        }
        Ok(Self { network, layers })
    }
}

impl Engine for CandleCpu<'_> {
    fn name(&self) -> String {
        "candle 0.11.1".into()
    }

    fn settings(&self) -> &'static str {
        "RAYON_NUM_THREADS=1 (then it spawns none); `candle_nn::Linear`"
    }

    fn act(
        &mut self,
        obs_raw: &[f32; OBSERVATION],
        action: &mut [f32; ACTION],
    ) -> Result<(), Box<dyn Error>> {
        let mut values = vec![0.0; OBSERVATION];
        self.network.standardise(obs_raw, &mut values);
        let mut values = Tensor::from_vec(values, (1, OBSERVATION), &Device::Cpu)?;
        for (index, layer) in self.layers.iter().enumerate() {
            let sums = layer.forward(&values)?;
            values = match index + 1 == self.layers.len() {
                true => sums.tanh()?,
                false => sums.relu()?,
            };
        }
        action.copy_from_slice(&values.flatten_all()?.to_vec1::<f32>()?);
        Ok(())
    }
}
