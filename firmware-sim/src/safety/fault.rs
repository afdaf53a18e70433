//! Why the controller stopped flying the policy: a reason with its evidence, and a stable code for logs and wires.

use core::error::Error;
use core::fmt;

use serde::{Deserialize, Serialize};

/// The reason a fault was latched.
///
/// | code | reason |
/// |---|---|
/// | 1 | an observation value is NaN or infinite |
/// | 2 | an observation value is outside the contract's range |
/// | 3 | the observation has the wrong number of values |
/// | 4 | the observation is too old, or stamped in the future |
/// | 5 | an observation was lost, repeated or reordered |
/// | 6 | the policy gave NaN or an infinite action |
/// | 7 | the tick came too late too often in a row |
/// | 8 | the clock went backwards |
/// | 9 | the policy refused the shapes it was given |
/// | 10 | the link fell silent |
///
/// On a wire a fault is its variant's number, one less than its code, and its evidence.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Fault {
    /// An observation value is NaN or infinite.
    NotFinite {
        /// Its channel.
        index: usize,
    },
    /// An observation value is outside the contract's range.
    OutOfRange {
        /// Its channel.
        index: usize,
    },
    /// The observation has the wrong number of values.
    WrongLength {
        /// Values in the contract.
        expected: usize,
        /// Values in the frame.
        actual: usize,
    },
    /// The observation is too old, or stamped in the future.
    Stale {
        /// The frame's time stamp.
        stamp_us: u64,
        /// The controller's clock.
        now_us: u64,
    },
    /// The observation does not follow the last one: a frame was lost, repeated or reordered.
    OutOfSequence {
        /// The number that should have come.
        expected: u32,
        /// The number that came.
        actual: u32,
    },
    /// The policy gave NaN or an infinite action.
    ActionNotFinite {
        /// Its channel.
        index: usize,
    },
    /// Too many ticks in a row came late.
    DeadlineMissed {
        /// How long after the previous tick the last one came.
        elapsed_us: u64,
    },
    /// The clock went backwards between two ticks.
    ClockWentBack {
        /// The previous tick's time.
        last_us: u64,
        /// This tick's time.
        now_us: u64,
    },
    /// The policy refused the shapes it was given; a loaded controller rules this out.
    PolicyRefused,
    /// No observation came for too long; only a device that waits for its host knows this one.
    LinkSilent {
        /// How long it waits.
        limit_us: u32,
    },
}

impl Fault {
    /// The reason as a number that never changes its meaning.
    #[must_use]
    pub const fn code(self) -> u8 {
        match self {
            Self::NotFinite { .. } => 1,
            Self::OutOfRange { .. } => 2,
            Self::WrongLength { .. } => 3,
            Self::Stale { .. } => 4,
            Self::OutOfSequence { .. } => 5,
            Self::ActionNotFinite { .. } => 6,
            Self::DeadlineMissed { .. } => 7,
            Self::ClockWentBack { .. } => 8,
            Self::PolicyRefused => 9,
            Self::LinkSilent { .. } => 10,
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { index } => write!(f, "observation {index} is not finite"),
            Self::OutOfRange { index } => write!(f, "observation {index} is out of range"),
            Self::WrongLength { expected, actual } => {
                write!(f, "observation has {actual} values, not {expected}")
            }
            Self::Stale { stamp_us, now_us } if stamp_us > now_us => {
                write!(f, "observation is stamped {} us ahead", stamp_us - now_us)
            }
            Self::Stale { stamp_us, now_us } => {
                write!(f, "observation is {} us old", now_us - stamp_us)
            }
            Self::OutOfSequence { expected, actual } => {
                write!(f, "observation {actual} came instead of {expected}")
            }
            Self::ActionNotFinite { index } => write!(f, "action {index} is not finite"),
            Self::DeadlineMissed { elapsed_us } => {
                write!(f, "ticks are late, the last came after {elapsed_us} us")
            }
            Self::ClockWentBack { last_us, now_us } => {
                write!(f, "clock went back from {last_us} to {now_us} us")
            }
            Self::PolicyRefused => write!(f, "policy refused its input"),
            Self::LinkSilent { limit_us } => write!(f, "no observation came for {limit_us} us"),
        }
    }
}

impl Error for Fault {}
