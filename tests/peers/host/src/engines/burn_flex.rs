//! burn on its flex device, with the features that the trainer builds it with.

use std::error::Error;

use burn::tensor::activation::{relu, tanh};
use burn::tensor::module::linear;
use burn::tensor::{Device, Tensor, TensorData};

use super::Engine;
use crate::network::{ACTION, Network, OBSERVATION};

pub struct BurnFlex<'n> {
    network: &'n Network,
    device: Device,
    layers: Vec<(Tensor<2>, Tensor<1>)>,
}

impl<'n> BurnFlex<'n> {
    pub fn new(network: &'n Network) -> Self {
        let device = Device::flex();
        let layers = network.layers.iter().map(|layer| {
            let weights = TensorData::new(layer.weights.clone(), [layer.outputs, layer.inputs]);
            let bias = TensorData::new(layer.bias.clone(), [layer.outputs]);
            // A view `[in, out]` of rows that are whole in memory: faster here than burn's own order.
            let weights = Tensor::<2>::from_data(weights, &device).transpose();
            (weights, Tensor::from_data(bias, &device))
        });
        Self {
            network,
            layers: layers.collect(),
            device,
        }
    }
}

impl Engine for BurnFlex<'_> {
    fn name(&self) -> String {
        "burn flex 0.22.1".into()
    }

    fn settings(&self) -> &'static str {
        "RAYON_NUM_THREADS=1; features simd, rayon, x86-v4; `module::linear`, weights in the faster of the two orders"
    }

    fn act(
        &mut self,
        obs_raw: &[f32; OBSERVATION],
        action: &mut [f32; ACTION],
    ) -> Result<(), Box<dyn Error>> {
        let mut values = vec![0.0; OBSERVATION];
        self.network.standardise(obs_raw, &mut values);
        let mut values: Tensor<2> =
            Tensor::from_data(TensorData::new(values, [1, OBSERVATION]), &self.device);
        for (index, (weights, bias)) in self.layers.iter().enumerate() {
            let sums = linear(values, weights.clone(), Some(bias.clone()));
            values = match index + 1 == self.layers.len() {
                true => tanh(sums),
                false => relu(sums),
            };
        }
        let data = values.into_data();
        action.copy_from_slice(data.as_slice().map_err(|error| format!("{error:?}"))?);
        Ok(())
    }
}
