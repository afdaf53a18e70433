//! The perceptron itself: forward, forward with a tape, and the gradients of its parameters, on either engine.

use std::ops::Range;

use burn::tensor::{Tensor, TensorData};
use rand::Rng;

use super::parameters::{Gradients, Parameters};
use super::passes::Passes;
use super::plain::{self, Plain};
use super::{Backend, ExportedMlp, Initialiser, fused};

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
    pub(crate) parameters: Parameters,
    output: Activation,
}

/// What the backward pass needs of a forward pass.
pub(crate) enum Tape {
    /// Of tensors.
    Plain(plain::Tape),
    /// Of buffers.
    Fused(fused::Tape),
}

impl Mlp {
    /// Fresh members, one generator each: member `m` does not depend on how many members there are.
    pub(crate) fn new<R: Rng>(
        shape: &MlpShape,
        init: Initialiser,
        members: &mut [R],
        backend: Backend,
    ) -> Self {
        let device = backend.device();
        let layers = shape
            .layers()
            .map(|(inputs, outputs)| {
                let (mut weights, mut biases) = (Vec::new(), Vec::new());
                for rng in members.iter_mut() {
                    let (weight, bias) = init.draw(inputs, outputs, rng);
                    weights.extend(weight);
                    biases.extend(bias);
                }
                let weights = TensorData::new(weights, [members.len(), inputs, outputs]);
                let biases = TensorData::new(biases, [members.len(), 1, outputs]);
                Linear {
                    weight: Tensor::from_data(weights, &device),
                    bias: Tensor::from_data(biases, &device),
                }
            })
            .collect();
        Self::from_layers(layers, shape.output, backend)
    }

    /// A perceptron of given layers.
    pub(crate) fn from_layers(layers: Vec<Linear>, output: Activation, backend: Backend) -> Self {
        let parameters = match backend {
            Backend::Fused => Parameters::Fused(fused::Buffer::from_layers(&layers)),
            Backend::Flex | Backend::Ndarray | Backend::Cuda => {
                Parameters::Plain(Plain::new(layers, Passes::of(backend)))
            }
        };
        Self { parameters, output }
    }

    /// The one member that was exported, on any backend.
    pub(crate) fn from_exported(exported: &ExportedMlp, backend: Backend) -> Self {
        let device = backend.device();
        let layers = exported.layers.iter().map(|layer| {
            let outputs = layer.bias.len();
            let inputs = layer.weight.len() / outputs;
            let weight = TensorData::new(layer.weight.clone(), [1, outputs, inputs]);
            let bias = TensorData::new(layer.bias.clone(), [1, 1, outputs]);
            Linear {
                weight: Tensor::from_data(weight, &device).swap_dims(1, 2),
                bias: Tensor::from_data(bias, &device),
            }
        });
        Self::from_layers(layers.collect(), exported.output, backend)
    }

    /// One member as a network of its own.
    pub(crate) fn member(&self, member: usize) -> Self {
        let own = |t: Tensor<3>| t.narrow(0, member, 1);
        let layers = self.parameters.layers().into_iter();
        let layers = layers.map(|layer| Linear {
            weight: own(layer.weight),
            bias: own(layer.bias),
        });
        let mut alone = self.clone();
        alone.parameters.set_layers(layers.collect());
        alone
    }

    /// Activation of the last layer.
    #[must_use]
    pub fn output(&self) -> Activation {
        self.output
    }

    /// `[member, batch, in] -> [member, batch, out]`; an input with one member is shared by all.
    pub(crate) fn forward(&self, x: Tensor<3>) -> Tensor<3> {
        match &self.parameters {
            Parameters::Plain(plain) => plain.run(x, self.output, |_| ()),
            Parameters::Fused(fused) => fused.forward(x, self.output),
        }
    }

    /// The same, keeping what [`Self::gradients`] needs.
    pub(crate) fn forward_tape(&self, x: Tensor<3>) -> (Tensor<3>, Tape) {
        match &self.parameters {
            Parameters::Plain(plain) => {
                let (y, tape) = plain.forward_tape(x, self.output);
                (y, Tape::Plain(tape))
            }
            Parameters::Fused(fused) => {
                let (y, tape) = fused.forward_tape(x, self.output);
                (y, Tape::Fused(tape))
            }
        }
    }

    /// Gradients of a scalar loss in the parameters, from its gradient `[member, batch, out]` in the output.
    pub(crate) fn gradients(&self, tape: Tape, d_output: Tensor<3>) -> Gradients {
        match (&self.parameters, tape) {
            (Parameters::Plain(plain), Tape::Plain(tape)) => {
                Gradients::Plain(plain.gradients(tape, self.output, d_output))
            }
            (Parameters::Fused(fused), Tape::Fused(tape)) => {
                Gradients::Fused(fused.gradients(&tape, d_output))
            }
            _ => unreachable!("a tape is of the network that made it"),
        }
    }

    /// Gradient of a scalar loss in the input `[member, batch, in]`, from its gradient `[member, batch, out]` in the output;
    /// of an input that all members share, each member's own.
    pub(crate) fn input_gradient(&self, tape: Tape, d_output: Tensor<3>) -> Tensor<3> {
        match (&self.parameters, tape) {
            (Parameters::Plain(plain), Tape::Plain(tape)) => {
                plain.input_gradient(tape, self.output, d_output)
            }
            (Parameters::Fused(fused), Tape::Fused(tape)) => fused.input_gradient(&tape, d_output),
            _ => unreachable!("a tape is of the network that made it"),
        }
    }

    /// Lets these outputs be 0 whatever the input is.
    pub(crate) fn silence(&mut self, outputs: Range<usize>) {
        let mut layers = self.parameters.layers();
        if let Some(last) = layers.last_mut() {
            let silent = |t: &Tensor<3>| {
                let [members, rows, width] = t.dims();
                let quiet = Tensor::zeros([members, rows, outputs.len()], &t.device());
                debug_assert!(outputs.end <= width);
                t.clone()
                    .slice_assign([0..members, 0..rows, outputs.clone()], quiet)
            };
            last.weight = silent(&last.weight);
            last.bias = silent(&last.bias);
        }
        self.parameters.set_layers(layers);
    }

    /// Shrinks each weight matrix whose Frobenius norm is above `limit` to that norm; biases stay.
    pub(crate) fn project(&mut self, limit: f64) {
        self.parameters.project(limit);
    }

    /// Takes this share away from every weight and bias: a decay that goes past the moments of an optimiser.
    pub(crate) fn shrink(&mut self, share: f64) {
        let nothing = self.parameters.zeros_like();
        self.parameters.polyak(&nothing, share as f32);
    }

    /// Moves towards `source`: `self <- rate * source + (1 - rate) * self` (Polyak averaging of target networks).
    pub(crate) fn polyak(&mut self, source: &Self, rate: f64) {
        self.parameters.polyak(&source.parameters, rate as f32);
    }
}
