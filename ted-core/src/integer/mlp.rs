//! A multilayer perceptron in integers: dense layers with ReLU between them.

use heapless::Vec;

use super::dense::{IntegerDense, MAX_ACTIVATION};
use super::error::IntegerError;
use super::kernel::dense;
use super::scratch::{IntegerPingPong, IntegerScratch};
use super::tanh::tanh_q15;
use crate::error::{Part, ShapeError};
use crate::limits::{MAX_LAYERS, MAX_WIDTH};
use crate::mlp::Output;

/// Most fraction bits of a 16-bit activation.
pub const MAX_FRACTION_BITS: u8 = 15;

/// Fraction bits of a number in [-1, 1].
pub const Q15: u8 = 15;

/// Passes when a 16-bit activation has room for so many fraction bits.
pub(super) fn check_fraction_bits(fraction_bits: [u8; 2]) -> Result<(), IntegerError> {
    match fraction_bits
        .into_iter()
        .find(|bits| *bits > MAX_FRACTION_BITS)
    {
        Some(actual) => Err(IntegerError::FractionBits {
            limit: MAX_FRACTION_BITS,
            actual,
        }),
        None => Ok(()),
    }
}

/// A network in integers whose layers are proved to chain. Hidden layers are ReLU.
#[derive(Clone, Debug)]
pub struct IntegerMlp<'a> {
    layers: Vec<IntegerDense<'a>, MAX_LAYERS>,
    output: Output,
}

impl<'a> IntegerMlp<'a> {
    /// Chains the layers, first to last.
    ///
    /// # Errors
    /// When there is no layer, more than [`MAX_LAYERS`], or a layer does not read what the one before it writes.
    pub fn new(layers: &[IntegerDense<'a>], output: Output) -> Result<Self, ShapeError> {
        ShapeError::within(Part::Layers, MAX_LAYERS, layers.len())?;
        for (before, after) in layers.iter().zip(layers.iter().skip(1)) {
            ShapeError::same(Part::Inputs, before.outputs(), after.inputs())?;
        }
        let too_many = |_| ShapeError::TooLarge {
            part: Part::Layers,
            limit: MAX_LAYERS,
            actual: layers.len(),
        };
        Ok(Self {
            layers: Vec::from_slice(layers).map_err(too_many)?,
            output,
        })
    }

    /// The layers, first to last.
    #[must_use]
    pub fn layers(&self) -> &[IntegerDense<'a>] {
        &self.layers
    }

    /// Activation of the last layer.
    #[must_use]
    pub fn output(&self) -> Output {
        self.output
    }

    /// Fraction bits of an output, when the last layer has these before its activation: [`Q15`] after a tanh.
    #[must_use]
    pub(super) fn activated_fraction_bits(&self, fraction_bits: u8) -> u8 {
        match self.output {
            Output::Linear => fraction_bits,
            Output::Tanh => Q15,
        }
    }

    /// Number of inputs.
    #[must_use]
    pub fn inputs(&self) -> usize {
        self.layers.first().map_or(0, IntegerDense::inputs)
    }

    /// Number of outputs.
    #[must_use]
    pub fn outputs(&self) -> usize {
        self.layers.last().map_or(0, IntegerDense::outputs)
    }

    /// Runs the network on one input. The last layer has `fraction_bits` before its activation.
    ///
    /// # Errors
    /// When `x` or `out` has another length than the network.
    pub fn forward(
        &self,
        x: &[i16],
        fraction_bits: u8,
        scratch: &mut IntegerScratch,
        out: &mut [i16],
    ) -> Result<(), ShapeError> {
        self.run(x, fraction_bits, &mut scratch.ping_pong, out)
    }

    pub(super) fn run(
        &self,
        x: &[i16],
        fraction_bits: u8,
        buffers: &mut IntegerPingPong,
        out: &mut [i16],
    ) -> Result<(), ShapeError> {
        ShapeError::same(Part::Input, self.inputs(), x.len())?;
        ShapeError::same(Part::Output, self.outputs(), out.len())?;
        let Some((last, hidden)) = self.layers.split_last() else {
            return Err(ShapeError::Empty { part: Part::Layers });
        };
        let (mut read, mut write) = (&mut buffers.ping[..], &mut buffers.pong[..]);
        let mut width = None;
        for layer in hidden {
            let input = match width {
                None => x,
                Some(width) => within(read.get(..width), width)?,
            };
            let outputs = layer.outputs();
            let output = within(write.get_mut(..outputs), outputs)?;
            dense(layer, input, output, 0);
            width = Some(outputs);
            core::mem::swap(&mut read, &mut write);
        }
        let input = match width {
            None => x,
            Some(width) => within(read.get(..width), width)?,
        };
        dense(last, input, out, -MAX_ACTIVATION);
        if self.output == Output::Tanh {
            for y in out {
                *y = tanh_q15(*y, fraction_bits);
            }
        }
        Ok(())
    }
}

/// A part of a buffer that every layer fits in.
fn within<T>(part: Option<T>, width: usize) -> Result<T, ShapeError> {
    part.ok_or(ShapeError::TooLarge {
        part: Part::Outputs,
        limit: MAX_WIDTH,
        actual: width,
    })
}
