//! A multilayer perceptron: dense layers with ReLU between them.

use heapless::Vec;

use crate::activation::Activation;
use crate::dense::Dense;
use crate::error::{Part, ShapeError};
use crate::limits::MAX_LAYERS;
use crate::scratch::{PingPong, Scratch};

/// Activation of the last layer. Hidden layers are always ReLU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// The sum as it is.
    Linear,
    /// [`crate::activation::tanh`].
    Tanh,
}

/// A network whose layers are proved to chain.
#[derive(Clone, Debug)]
pub struct Mlp<'a> {
    hidden: Vec<Dense<'a>, MAX_LAYERS>,
    last: Dense<'a>,
    output: Output,
}

impl<'a> Mlp<'a> {
    /// Chains the layers, first to last.
    ///
    /// # Errors
    /// When there is no layer, more than [`MAX_LAYERS`], or a layer does not read what the one before it writes.
    pub fn new(layers: &[Dense<'a>], output: Output) -> Result<Self, ShapeError> {
        ShapeError::within(Part::Layers, MAX_LAYERS, layers.len())?;
        for (before, after) in layers.iter().zip(layers.iter().skip(1)) {
            ShapeError::same(Part::Inputs, before.outputs(), after.inputs())?;
        }
        let Some((last, hidden)) = layers.split_last() else {
            return Err(ShapeError::Empty { part: Part::Layers });
        };
        let too_many = |_| ShapeError::TooLarge {
            part: Part::Layers,
            limit: MAX_LAYERS,
            actual: layers.len(),
        };
        Ok(Self {
            hidden: Vec::from_slice(hidden).map_err(too_many)?,
            last: *last,
            output,
        })
    }

    /// Number of inputs.
    #[must_use]
    pub fn inputs(&self) -> usize {
        self.hidden.first().unwrap_or(&self.last).inputs()
    }

    /// Number of outputs.
    #[must_use]
    pub fn outputs(&self) -> usize {
        self.last.outputs()
    }

    /// Activation of the last layer.
    #[must_use]
    pub fn output(&self) -> Output {
        self.output
    }

    /// The layers, first to last.
    pub fn layers(&self) -> impl Iterator<Item = &Dense<'a>> {
        self.hidden.iter().chain(core::iter::once(&self.last))
    }

    /// Runs the network on one input.
    ///
    /// # Errors
    /// When `x` or `out` has another length than the network.
    pub fn forward(
        &self,
        x: &[f32],
        scratch: &mut Scratch,
        out: &mut [f32],
    ) -> Result<(), ShapeError> {
        self.run(x, &mut scratch.ping_pong, out)
    }

    pub(crate) fn run(
        &self,
        x: &[f32],
        buffers: &mut PingPong,
        out: &mut [f32],
    ) -> Result<(), ShapeError> {
        let (mut read, mut write) = (&mut buffers.ping[..], &mut buffers.pong[..]);
        let mut width = None;
        for layer in &self.hidden {
            let input = match width {
                None => x,
                Some(width) => prefix(read, width)?,
            };
            layer.apply(input, prefix_mut(write, layer.outputs())?, Activation::Relu)?;
            width = Some(layer.outputs());
            core::mem::swap(&mut read, &mut write);
        }
        let input = match width {
            None => x,
            Some(width) => prefix(read, width)?,
        };
        let activation = match self.output {
            Output::Linear => Activation::Linear,
            Output::Tanh => Activation::Tanh,
        };
        self.last.apply(input, out, activation)
    }
}

fn prefix(buffer: &[f32], width: usize) -> Result<&[f32], ShapeError> {
    let limit = buffer.len();
    buffer.get(..width).ok_or(ShapeError::TooLarge {
        part: Part::Outputs,
        limit,
        actual: width,
    })
}

fn prefix_mut(buffer: &mut [f32], width: usize) -> Result<&mut [f32], ShapeError> {
    let limit = buffer.len();
    buffer.get_mut(..width).ok_or(ShapeError::TooLarge {
        part: Part::Outputs,
        limit,
        actual: width,
    })
}
