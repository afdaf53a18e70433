//! The perceptron itself: forward, forward with a tape, and the gradients of its parameters.

use burn::tensor::{Device, Tensor, TensorData};
use rand::Rng;

use super::Initialiser;
use super::host::{self, in_place};

/// The function applied to the output of the last layer. Hidden layers are always ReLU.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Activation {
    /// None.
    Linear,
    /// Hyperbolic tangent.
    Tanh,
}

/// Sizes of a perceptron: `widths[0]` inputs, hidden widths, `widths.last()` outputs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MlpShape {
    /// Every width from input to output.
    pub widths: Vec<usize>,
    /// Activation of the last layer.
    pub output: Activation,
}

impl MlpShape {
    /// A perceptron with these hidden widths.
    #[must_use]
    pub fn new(inputs: usize, hidden: &[usize], outputs: usize, output: Activation) -> Self {
        let widths = [&[inputs], hidden, &[outputs]].concat();
        Self { widths, output }
    }

    /// Inputs and outputs of each layer.
    pub fn layers(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.widths.windows(2).map(|w| (w[0], w[1]))
    }
}

/// Weight `[member, in, out]` and bias `[member, 1, out]` of one layer; also the type of their gradients.
#[derive(Clone, Debug)]
pub struct Linear {
    pub(crate) weight: Tensor<3>,
    pub(crate) bias: Tensor<3>,
}

/// A perceptron with a leading member axis.
#[derive(Clone, Debug)]
pub struct Mlp {
    pub(crate) layers: Vec<Linear>,
    output: Activation,
}

/// What the backward pass needs of a forward pass: the input of each layer and the network's output.
pub struct Tape {
    inputs: Vec<Tensor<3>>,
    output: Tensor<3>,
}

impl Mlp {
    /// Fresh members, one generator each: member `m` does not depend on how many members there are.
    pub(crate) fn new<R: Rng>(
        shape: &MlpShape,
        init: Initialiser,
        members: &mut [R],
        device: &Device,
    ) -> Self {
        let layers = shape
            .layers()
            .map(|(inputs, outputs)| {
                let (mut weights, mut biases) = (Vec::new(), Vec::new());
                for rng in members.iter_mut() {
                    let (weight, bias) = init.draw(inputs, outputs, rng);
                    weights.extend(weight);
                    biases.extend(bias);
                }
                Linear {
                    weight: Tensor::from_data(
                        TensorData::new(weights, [members.len(), inputs, outputs]),
                        device,
                    ),
                    bias: Tensor::from_data(
                        TensorData::new(biases, [members.len(), 1, outputs]),
                        device,
                    ),
                }
            })
            .collect();
        Self {
            layers,
            output: shape.output,
        }
    }

    /// A perceptron of given layers.
    #[cfg(test)]
    pub(crate) fn from_layers(layers: Vec<Linear>, output: Activation) -> Self {
        Self { layers, output }
    }

    /// Activation of the last layer.
    #[must_use]
    pub fn output(&self) -> Activation {
        self.output
    }

    /// `[member, batch, in] -> [member, batch, out]`; an input with one member is shared by all.
    pub(crate) fn forward(&self, x: Tensor<3>) -> Tensor<3> {
        self.run(x, |_| ())
    }

    /// The same, keeping what [`Self::gradients`] needs.
    pub(crate) fn forward_tape(&self, x: Tensor<3>) -> (Tensor<3>, Tape) {
        let mut inputs = Vec::with_capacity(self.layers.len());
        let output = self.run(x, |h| inputs.push(h.clone()));
        (output.clone(), Tape { inputs, output })
    }

    fn run(&self, x: Tensor<3>, mut seen: impl FnMut(&Tensor<3>)) -> Tensor<3> {
        let last = self.layers.len() - 1;
        let mut h = x;
        for (i, layer) in self.layers.iter().enumerate() {
            seen(&h);
            let mut z = h.matmul(layer.weight.clone());
            host::add_bias(&mut z, &layer.bias, i != last);
            h = match (i == last, self.output) {
                (false, _) | (true, Activation::Linear) => z,
                (true, Activation::Tanh) => z.tanh(),
            };
        }
        h
    }

    /// Gradients of a scalar loss in the parameters, from its gradient `[member, batch, out]` in the output.
    pub(crate) fn gradients(&self, tape: Tape, d_output: Tensor<3>) -> Vec<Linear> {
        let mut delta = match self.output {
            Activation::Linear => d_output,
            Activation::Tanh => {
                d_output * (tape.output.clone() * tape.output).neg().add_scalar(1.0)
            }
        };
        let mut gradients = Vec::with_capacity(self.layers.len());
        for (i, (layer, input)) in self.layers.iter().zip(tape.inputs).enumerate().rev() {
            let bias = delta.clone().sum_dim(1);
            let weight = input.clone().swap_dims(1, 2).matmul(delta.clone());
            if i > 0 {
                // ReLU passes the gradient where its output is positive.
                delta = delta.matmul(layer.weight.clone().swap_dims(1, 2));
                host::mask_inactive(&mut delta, input);
            }
            gradients.push(Linear { weight, bias });
        }
        gradients.reverse();
        gradients
    }

    /// Moves towards `source`: `self <- rate * source + (1 - rate) * self` (Polyak averaging of target networks).
    pub(crate) fn polyak(&mut self, source: &Self, rate: f64) {
        let rate = rate as f32;
        let mix = |old: &mut Tensor<3>, new: &Tensor<3>| {
            let new = new.clone().into_data();
            let new = new.as_slice::<f32>().expect("parameters are f32");
            in_place([old], |[old]| {
                for (old, new) in old.iter_mut().zip(new) {
                    *old = (1.0 - rate) * *old + rate * new;
                }
            });
        };
        for (old, new) in self.layers.iter_mut().zip(&source.layers) {
            mix(&mut old.weight, &new.weight);
            mix(&mut old.bias, &new.bias);
        }
    }
}
