//! A policy in integers.

use super::error::IntegerError;
use super::mlp::{IntegerMlp, check_fraction_bits};
use super::scratch::{IntegerPingPong, IntegerScratch};
use crate::error::{Part, ShapeError};
use crate::limits::{MAX_ACTION, MAX_OBSERVATION};

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
    /// An input is `floor(obs_norm * 2^input_fraction_bits + 1/2)`, saturated ([`crate::quantised::fixed`]); an output of the last layer, before its
    /// activation, has `output_fraction_bits`.
    ///
    /// # Errors
    /// When a number of fraction bits is more than [`super::MAX_FRACTION_BITS`], or there are too many channels.
    pub fn new(
        input_fraction_bits: u8,
        output_fraction_bits: u8,
        mlp: IntegerMlp<'a>,
    ) -> Result<Self, IntegerError> {
        check_fraction_bits([input_fraction_bits, output_fraction_bits])?;
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

    /// Fraction bits of an action: [`super::Q15`] of a policy that ends in a tanh, otherwise those of the last layer.
    #[must_use]
    pub fn action_fraction_bits(&self) -> u8 {
        self.mlp.activated_fraction_bits(self.output_fraction_bits)
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
        self.run(obs_fixed, &mut scratch.ping_pong, action_fixed)
    }

    pub(crate) fn run(
        &self,
        obs_fixed: &[i16],
        buffers: &mut IntegerPingPong,
        action_fixed: &mut [i16],
    ) -> Result<(), ShapeError> {
        self.mlp
            .run(obs_fixed, self.output_fraction_bits, buffers, action_fixed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integer::IntegerDense;
    use crate::mlp::Output;

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
