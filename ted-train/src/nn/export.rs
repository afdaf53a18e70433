//! Weights off the device, in the controller's layout.

use burn::tensor::Tensor;
use serde::{Deserialize, Serialize};
use ted_core::{Dense, Output, ShapeError};

use super::{Activation, Mlp};

/// One member of a perceptron as plain arrays.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExportedMlp {
    /// Layers from input to output.
    pub layers: Vec<ExportedLayer>,
    /// Activation of the last layer.
    pub output: Activation,
}

/// A layer: `y = weight x + bias`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExportedLayer {
    /// `[out][in]`, row-major.
    pub weight: Vec<f32>,
    /// `[out]`.
    pub bias: Vec<f32>,
}

impl ExportedMlp {
    /// Every member of a perceptron, in order.
    #[must_use]
    pub fn members(network: &Mlp) -> Vec<Self> {
        let layers = network.parameters.layers();
        let count = layers.first().map_or(0, |l| l.weight.dims()[0]);
        let mut members = vec![
            Self {
                layers: Vec::new(),
                output: network.output()
            };
            count
        ];
        for layer in layers {
            // The controller reads the weights of one output after the other.
            let weight = values(layer.weight.swap_dims(1, 2));
            let bias = values(layer.bias);
            let (per_weight, per_bias) = (weight.len() / count, bias.len() / count);
            let parts = weight
                .chunks_exact(per_weight)
                .zip(bias.chunks_exact(per_bias));
            for (member, (weight, bias)) in members.iter_mut().zip(parts) {
                member.layers.push(ExportedLayer {
                    weight: weight.to_vec(),
                    bias: bias.to_vec(),
                });
            }
        }
        members
    }

    /// The controller's view of it.
    ///
    /// # Errors
    /// When it is larger than the controller's limits.
    pub fn view(&self) -> Result<ted_core::Mlp<'_>, ShapeError> {
        let layers = self
            .layers
            .iter()
            .map(ExportedLayer::view)
            .collect::<Result<Vec<_>, _>>()?;
        let output = match self.output {
            Activation::Linear => Output::Linear,
            Activation::Tanh => Output::Tanh,
        };
        ted_core::Mlp::new(&layers, output)
    }
}

impl ExportedLayer {
    fn view(&self) -> Result<Dense<'_>, ShapeError> {
        let (outputs, weights) = (self.bias.len(), self.weight.len());
        Dense::new(weights / outputs.max(1), outputs, &self.weight, &self.bias)
    }
}

fn values(tensor: Tensor<3>) -> Vec<f32> {
    tensor
        .into_data()
        .try_to_vec()
        .expect("a float tensor holds f32")
}
