//! The one error of this crate: two sizes that had to agree and did not.

use core::fmt;

/// What was measured when a size was wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Part {
    /// Inputs of a dense layer.
    Inputs,
    /// Outputs of a dense layer.
    Outputs,
    /// Weights of a dense layer.
    Weights,
    /// Biases of a dense layer.
    Bias,
    /// Requantisation factors of an integer layer.
    Multipliers,
    /// Requantisation shifts of an integer layer.
    Shifts,
    /// Layers of a network.
    Layers,
    /// Members of an ensemble.
    Members,
    /// Shifts of a normaliser.
    Shift,
    /// Scales of a normaliser.
    Scale,
    /// Channels of an observation.
    Observation,
    /// Channels of an action.
    Action,
    /// Values written by a network.
    Output,
    /// Values read by a network.
    Input,
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Inputs => "layer inputs",
            Self::Outputs => "layer outputs",
            Self::Weights => "layer weights",
            Self::Bias => "layer biases",
            Self::Multipliers => "layer multipliers",
            Self::Shifts => "layer shifts",
            Self::Layers => "network layers",
            Self::Members => "ensemble members",
            Self::Shift => "normaliser shifts",
            Self::Scale => "normaliser scales",
            Self::Observation => "observation channels",
            Self::Action => "action channels",
            Self::Output => "network outputs",
            Self::Input => "network inputs",
        })
    }
}

/// Sizes that do not fit together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ShapeError {
    /// A slice or a layer has another size than its neighbour asks for.
    Mismatch {
        /// What was measured.
        part: Part,
        /// The size it must have.
        expected: usize,
        /// The size it has.
        actual: usize,
    },
    /// There are none of something that must be there.
    Empty {
        /// What is missing.
        part: Part,
    },
    /// There is more of something than this build has room for.
    TooLarge {
        /// What was measured.
        part: Part,
        /// The largest size there is room for.
        limit: usize,
        /// The size it has.
        actual: usize,
    },
}

impl ShapeError {
    /// Passes when `actual` is what was expected.
    pub(crate) fn same(part: Part, expected: usize, actual: usize) -> Result<(), Self> {
        if expected == actual {
            Ok(())
        } else {
            Err(Self::Mismatch {
                part,
                expected,
                actual,
            })
        }
    }

    /// Passes when `actual` lies in `1..=limit`.
    pub(crate) fn within(part: Part, limit: usize, actual: usize) -> Result<(), Self> {
        match actual {
            0 => Err(Self::Empty { part }),
            _ if actual > limit => Err(Self::TooLarge {
                part,
                limit,
                actual,
            }),
            _ => Ok(()),
        }
    }
}

impl fmt::Display for ShapeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Mismatch {
                part,
                expected,
                actual,
            } => {
                write!(f, "expected {expected} {part}, found {actual}")
            }
            Self::Empty { part } => write!(f, "no {part}"),
            Self::TooLarge {
                part,
                limit,
                actual,
            } => {
                write!(f, "{actual} {part}, there is room for {limit}")
            }
        }
    }
}

impl core::error::Error for ShapeError {}
