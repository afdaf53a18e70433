//! Why an integer layer or policy was refused.

use core::fmt;

use crate::error::ShapeError;

/// Why an integer layer or policy was refused.
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
    /// A range of sums is in disorder, or wider than an `i32`.
    Range {
        /// Its lower end.
        low: i32,
        /// Its upper end.
        high: i32,
    },
    /// A member of an ensemble ends in another activation than the first, so that their outputs cannot be added.
    Unit,
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
            Self::Range { low, high } => {
                write!(f, "integer rewards from {low} to {high} are no range")
            }
            Self::Unit => {
                f.write_str("integer ensemble has members that end in different activations")
            }
            Self::FractionBits { limit, actual } => {
                write!(f, "{actual} fraction bits, at most {limit} fit")
            }
        }
    }
}

impl core::error::Error for IntegerError {}
