//! What an action channel is sent once the policy no longer flies: `"zero"`, `"hold"`, or a number.

use std::fmt;

use serde::{Deserialize, Serialize};
use ted_policy::SafeAction;

/// A safe action, as `robot.toml` has it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "on_fault is \"zero\", \"hold\" (what was sent last), or a number in the channel's unit"
)]
pub enum OnFault {
    /// A number, in the channel's unit.
    Value(f32),
    /// One of the words.
    Word(Word),
}

/// What can be said without a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Word {
    /// A motion stops.
    Zero,
    /// What was sent last: a gripper keeps its grip.
    Hold,
}

impl OnFault {
    /// A motion stops.
    pub const ZERO: Self = Self::Word(Word::Zero);
    /// What was sent last.
    pub const HOLD: Self = Self::Word(Word::Hold);
}

impl From<OnFault> for SafeAction {
    fn from(on_fault: OnFault) -> Self {
        match on_fault {
            OnFault::Word(Word::Zero) => Self::Zero,
            OnFault::Word(Word::Hold) => Self::HoldLast,
            OnFault::Value(value) => Self::Value(value),
        }
    }
}

impl fmt::Display for OnFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Word(Word::Zero) => f.write_str("zero"),
            Self::Word(Word::Hold) => f.write_str("hold the last"),
            Self::Value(value) => write!(f, "{value}"),
        }
    }
}
