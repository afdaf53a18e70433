//! Integer network and policy.

use heapless::Vec;

use super::dense::IntegerDense;
use super::error::IntegerError;
use super::kernel::dense;
use super::scratch::IntegerScratch;
use super::tanh::tanh_q15;
use crate::error::{Part, ShapeError};
use crate::limits::{MAX_ACTION, MAX_LAYERS, MAX_OBSERVATION, MAX_WIDTH};
use crate::mlp::Output;

/// Most fraction bits of a 16-bit activation.
pub const MAX_FRACTION_BITS: u8 = 15;

/// Fraction bits of a number in [-1, 1].
pub const Q15: u8 = 15;

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

    /// Runs the layers on one input: ReLU after all but the last, and nothing after that.
    fn run(
        &self,
        x: &[i16],
        scratch: &mut IntegerScratch,
        out: &mut [i16],
    ) -> Result<(), ShapeError> {
        ShapeError::same(Part::Input, self.inputs(), x.len())?;
        ShapeError::same(Part::Output, self.outputs(), out.len())?;
        let Some((last, hidden)) = self.layers.split_last() else {
            return Err(ShapeError::Empty { part: Part::Layers });
        };
        let (mut read, mut write) = (&mut scratch.ping[..], &mut scratch.pong[..]);
        let mut width = None;
        for layer in hidden {
            let input = match width {
                None => x,
                Some(width) => within(read.get(..width), width)?,
            };
            let outputs = layer.outputs();
            let output = within(write.get_mut(..outputs), outputs)?;
            dense(layer, input, output, |y| y.max(0));
            width = Some(outputs);
            core::mem::swap(&mut read, &mut write);
        }
        let input = match width {
            None => x,
            Some(width) => within(read.get(..width), width)?,
        };
        dense(last, input, out, |y| y);
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

/// A policy in integers: it reads the standardised observation and writes the action, both as 16-bit fixed point.
#[derive(Clone, Debug)]
pub struct IntegerPolicy<'a> {
    input_fraction_bits: u8,
    output_fraction_bits: u8,
    mlp: IntegerMlp<'a>,
}

impl<'a> IntegerPolicy<'a> {
    /// Joins a network with the fixed point of its two ends.
    ///
    /// An input is `round(obs_norm * 2^input_fraction_bits)`, saturated; an output of the last layer, before its
    /// activation, has `output_fraction_bits`.
    ///
    /// # Errors
    /// When a number of fraction bits is more than [`MAX_FRACTION_BITS`], or there are too many channels.
    pub fn new(
        input_fraction_bits: u8,
        output_fraction_bits: u8,
        mlp: IntegerMlp<'a>,
    ) -> Result<Self, IntegerError> {
        for actual in [input_fraction_bits, output_fraction_bits] {
            if actual > MAX_FRACTION_BITS {
                return Err(IntegerError::FractionBits {
                    limit: MAX_FRACTION_BITS,
                    actual,
                });
            }
        }
        ShapeError::within(Part::Observation, MAX_OBSERVATION, mlp.inputs())?;
        ShapeError::within(Part::Action, MAX_ACTION, mlp.outputs())?;
        Ok(Self {
            input_fraction_bits,
            output_fraction_bits,
            mlp,
        })
    }

    /// Fraction bits of the standardised observation.
    #[must_use]
    pub fn input_fraction_bits(&self) -> u8 {
        self.input_fraction_bits
    }

    /// Fraction bits of the last layer before its activation.
    #[must_use]
    pub fn output_fraction_bits(&self) -> u8 {
        self.output_fraction_bits
    }

    /// The network.
    #[must_use]
    pub fn mlp(&self) -> &IntegerMlp<'a> {
        &self.mlp
    }

    /// Fraction bits of an action: [`Q15`] of a policy that ends in a tanh, otherwise those of the last layer.
    #[must_use]
    pub fn action_fraction_bits(&self) -> u8 {
        match self.mlp.output {
            Output::Linear => self.output_fraction_bits,
            Output::Tanh => Q15,
        }
    }

    /// Computes the action for one standardised observation, both in fixed point. No value of the observation makes it fail.
    ///
    /// # Errors
    /// When `obs_fixed` or `action_fixed` has another length than the policy.
    pub fn act(
        &self,
        obs_fixed: &[i16],
        scratch: &mut IntegerScratch,
        action_fixed: &mut [i16],
    ) -> Result<(), ShapeError> {
        self.mlp.run(obs_fixed, scratch, action_fixed)?;
        if self.mlp.output == Output::Tanh {
            for y in action_fixed {
                *y = tanh_q15(*y, self.output_fraction_bits);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MULTIPLIER: i32 = 1 << 30;

    #[test]
    fn layers_must_chain_and_fraction_bits_must_fit() {
        let first = IntegerDense::new(2, &[0; 6], &[0; 3], &[MULTIPLIER; 3], &[0; 3]).unwrap();
        let last = IntegerDense::new(3, &[0; 3], &[0; 1], &[MULTIPLIER; 1], &[0; 1]).unwrap();
        assert!(IntegerMlp::new(&[last, first], Output::Tanh).is_err());
        assert!(IntegerMlp::new(&[], Output::Tanh).is_err());
        let mlp = IntegerMlp::new(&[first, last], Output::Tanh).unwrap();
        assert_eq!((mlp.inputs(), mlp.outputs()), (2, 1));
        assert!(IntegerPolicy::new(12, 12, mlp.clone()).is_ok());
        let error = IntegerPolicy::new(12, 16, mlp).unwrap_err();
        assert_eq!(
            error,
            IntegerError::FractionBits {
                limit: 15,
                actual: 16
            }
        );
    }
}
