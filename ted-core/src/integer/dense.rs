//! One integer dense layer and the proof that its accumulator cannot overflow.

use core::fmt;

use crate::error::{Part, ShapeError};
use crate::limits::MAX_WIDTH;

/// Largest magnitude of a weight: symmetric, so -128 is not a weight.
pub const MAX_WEIGHT: i8 = 127;

/// Largest magnitude of an activation: symmetric, so -32768 is not an activation.
pub const MAX_ACTIVATION: i16 = 32767;

/// Smallest normalised requantisation multiplier; the largest is `i32::MAX`.
const MIN_MULTIPLIER: i32 = 1 << 30;

/// Requantisation shifts lie in `-31..=31`.
const MAX_SHIFT: i8 = 31;

/// Largest magnitude of a bias for which an accumulator over `inputs` products stays within `i32`.
///
/// `inputs * 127 * 32767 + limit == i32::MAX`; at the widest layer, 256 inputs, half of the range is left for the bias.
#[must_use]
pub const fn bias_limit(inputs: usize) -> i32 {
    let inputs = if inputs > MAX_WIDTH {
        MAX_WIDTH
    } else {
        inputs
    };
    i32::MAX - inputs as i32 * MAX_WEIGHT as i32 * MAX_ACTIVATION as i32
}

const _: () =
    assert!((MAX_WIDTH as i64) * (MAX_WEIGHT as i64) * (MAX_ACTIVATION as i64) < i32::MAX as i64);

/// Why an integer layer was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum IntegerError {
    /// The sizes do not fit together.
    Shape(ShapeError),
    /// A weight is -128.
    Weight {
        /// Where, row-major.
        index: usize,
    },
    /// A bias could make the accumulator overflow.
    Bias {
        /// Which output.
        index: usize,
        /// The largest magnitude allowed.
        limit: i32,
        /// What it is.
        actual: i32,
    },
    /// A multiplier is not in [2^30, 2^31).
    Multiplier {
        /// Which output.
        index: usize,
        /// What it is.
        actual: i32,
    },
    /// A shift is not in [-31, 31].
    Shift {
        /// Which output.
        index: usize,
        /// What it is.
        actual: i8,
    },
    /// A number of fraction bits is more than an `i16` has.
    FractionBits {
        /// The most there can be.
        limit: u8,
        /// What it is.
        actual: u8,
    },
}

impl From<ShapeError> for IntegerError {
    fn from(error: ShapeError) -> Self {
        Self::Shape(error)
    }
}

impl fmt::Display for IntegerError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Shape(error) => error.fmt(f),
            Self::Weight { index } => {
                write!(f, "integer weight {index} is -128, weights are symmetric")
            }
            Self::Bias {
                index,
                limit,
                actual,
            } => {
                write!(
                    f,
                    "integer bias {index} is {actual}, beyond {limit} the accumulator could overflow"
                )
            }
            Self::Multiplier { index, actual } => {
                write!(
                    f,
                    "integer multiplier {index} is {actual}, not in [2^30, 2^31)"
                )
            }
            Self::Shift { index, actual } => {
                write!(f, "integer shift {index} is {actual}, not in [-31, 31]")
            }
            Self::FractionBits { limit, actual } => {
                write!(f, "{actual} fraction bits, at most {limit} fit")
            }
        }
    }
}

impl core::error::Error for IntegerError {}

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
