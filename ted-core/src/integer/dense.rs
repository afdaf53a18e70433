//! One integer dense layer and the proof that its accumulator cannot overflow.

use super::error::IntegerError;
use crate::error::{Part, ShapeError};
use crate::limits::MAX_WIDTH;

/// Largest magnitude of a weight: symmetric, so -128 is not a weight.
pub const MAX_WEIGHT: i8 = 127;

/// Largest magnitude of an activation: symmetric, so -32768 is not an activation.
pub const MAX_ACTIVATION: i16 = 32767;

/// Largest magnitude of an `i16`: an activation never has it, but an input that somebody else made may.
const LARGEST_INPUT: i32 = 1 << 15;

/// Smallest normalised requantisation multiplier; the largest is `i32::MAX`.
const MIN_MULTIPLIER: i32 = 1 << 30;

/// Requantisation shifts lie in `-31..=31`.
const MAX_SHIFT: i8 = 31;

/// Largest magnitude of a bias for which an accumulator over `inputs` products stays within `i32`.
///
/// `inputs * 127 * 32768 + limit == i32::MAX`, which holds for an input of -32768 too; at the widest layer, 256 inputs, half of the
/// range is left for the bias.
#[must_use]
pub const fn bias_limit(inputs: usize) -> i32 {
    let inputs = if inputs > MAX_WIDTH {
        MAX_WIDTH
    } else {
        inputs
    };
    i32::MAX - inputs as i32 * MAX_WEIGHT as i32 * LARGEST_INPUT
}

const _: () =
    assert!((MAX_WIDTH as i64) * (MAX_WEIGHT as i64) * (LARGEST_INPUT as i64) < i32::MAX as i64);

/// A dense layer in integers. Per output: `acc = bias + sum(w * x)`, then `acc * multiplier * 2^(shift - 31)`.
#[derive(Clone, Copy, Debug)]
pub struct IntegerDense<'a> {
    inputs: usize,
    weights: &'a [i8],
    bias: &'a [i32],
    multipliers: &'a [i32],
    shifts: &'a [i8],
}

impl<'a> IntegerDense<'a> {
    /// Checks sizes and ranges and borrows the parameters; `weights` are row-major `[outputs][inputs]`.
    ///
    /// # Errors
    /// When sizes do not agree or any value could lead an accumulator out of `i32`.
    pub fn new(
        inputs: usize,
        weights: &'a [i8],
        bias: &'a [i32],
        multipliers: &'a [i32],
        shifts: &'a [i8],
    ) -> Result<Self, IntegerError> {
        let outputs = bias.len();
        ShapeError::within(Part::Inputs, MAX_WIDTH, inputs)?;
        ShapeError::within(Part::Outputs, MAX_WIDTH, outputs)?;
        ShapeError::same(Part::Weights, inputs * outputs, weights.len())?;
        ShapeError::same(Part::Multipliers, outputs, multipliers.len())?;
        ShapeError::same(Part::Shifts, outputs, shifts.len())?;
        if let Some(index) = weights.iter().position(|w| *w < -MAX_WEIGHT) {
            return Err(IntegerError::Weight { index });
        }
        let limit = bias_limit(inputs);
        for (index, &actual) in bias.iter().enumerate() {
            if !(-limit..=limit).contains(&actual) {
                return Err(IntegerError::Bias {
                    index,
                    limit,
                    actual,
                });
            }
        }
        for (index, &actual) in multipliers.iter().enumerate() {
            if actual < MIN_MULTIPLIER {
                return Err(IntegerError::Multiplier { index, actual });
            }
        }
        for (index, &actual) in shifts.iter().enumerate() {
            if !(-MAX_SHIFT..=MAX_SHIFT).contains(&actual) {
                return Err(IntegerError::Shift { index, actual });
            }
        }
        Ok(Self {
            inputs,
            weights,
            bias,
            multipliers,
            shifts,
        })
    }

    /// Number of inputs.
    #[must_use]
    pub fn inputs(&self) -> usize {
        self.inputs
    }

    /// Number of outputs.
    #[must_use]
    pub fn outputs(&self) -> usize {
        self.bias.len()
    }

    /// The weights, row-major `[outputs][inputs]`.
    #[must_use]
    pub fn weights(&self) -> &'a [i8] {
        self.weights
    }

    /// What each accumulator starts from.
    #[must_use]
    pub fn bias(&self) -> &'a [i32] {
        self.bias
    }

    /// The requantisation multiplier of each output, as a fraction of 2^31.
    #[must_use]
    pub fn multipliers(&self) -> &'a [i32] {
        self.multipliers
    }

    /// The requantisation shift of each output, to the left.
    #[must_use]
    pub fn shifts(&self) -> &'a [i8] {
        self.shifts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MULTIPLIER: i32 = 1 << 30;

    #[test]
    fn the_worst_accumulator_of_the_widest_layer_just_fits() {
        let product = i64::from(MAX_WEIGHT) * i64::from(i16::MIN).abs();
        for inputs in [1, 39, MAX_WIDTH] {
            assert_eq!(
                inputs as i64 * product + i64::from(bias_limit(inputs)),
                i64::from(i32::MAX)
            );
        }
    }

    #[test]
    fn a_bias_at_the_limit_is_taken_and_one_more_is_refused() {
        let layer =
            |bias: &[i32]| IntegerDense::new(2, &[1, 2], bias, &[MULTIPLIER], &[0]).map(|_| ());
        let limit = bias_limit(2);
        assert_eq!(layer(&[limit]), Ok(()));
        assert_eq!(layer(&[-limit]), Ok(()));
        let refused = |actual| {
            Err(IntegerError::Bias {
                index: 0,
                limit,
                actual,
            })
        };
        assert_eq!(layer(&[limit + 1]), refused(limit + 1));
        assert_eq!(layer(&[i32::MIN]), refused(i32::MIN));
    }

    #[test]
    fn values_out_of_range_are_refused() {
        let layer = |weight, multiplier, shift| {
            IntegerDense::new(1, &[weight], &[0], &[multiplier], &[shift]).map(|_| ())
        };
        assert_eq!(layer(-127, MULTIPLIER, -31), Ok(()));
        assert_eq!(
            layer(-128, MULTIPLIER, 0),
            Err(IntegerError::Weight { index: 0 })
        );
        let actual = MULTIPLIER - 1;
        assert_eq!(
            layer(1, actual, 0),
            Err(IntegerError::Multiplier { index: 0, actual })
        );
        assert_eq!(
            layer(1, MULTIPLIER, 32),
            Err(IntegerError::Shift {
                index: 0,
                actual: 32
            })
        );
        assert_eq!(
            layer(1, MULTIPLIER, i8::MIN),
            Err(IntegerError::Shift {
                index: 0,
                actual: i8::MIN
            })
        );
    }

    #[test]
    fn sizes_that_do_not_agree_are_refused() {
        let error = IntegerDense::new(2, &[0; 3], &[0; 2], &[MULTIPLIER; 2], &[0; 2]).unwrap_err();
        let expected = ShapeError::Mismatch {
            part: Part::Weights,
            expected: 4,
            actual: 3,
        };
        assert_eq!(error, IntegerError::Shape(expected));
        assert!(IntegerDense::new(0, &[], &[0], &[MULTIPLIER], &[0]).is_err());
        assert!(IntegerDense::new(1, &[0], &[0], &[], &[0]).is_err());
        assert!(IntegerDense::new(1, &[0], &[0], &[MULTIPLIER], &[]).is_err());
    }
}
