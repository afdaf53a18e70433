//! Choices of the simulated teacher.

use serde::{Deserialize, Serialize};

/// Who answers where no log does, and how badly. The default knows the true rewards and never errs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TeacherConfig {
    /// What answers go by.
    pub says: Says,
    /// Share of answers that are turned round, from 0 to 1. A tie has no other side.
    pub errs: f64,
    /// Clips are equal whose true returns differ by at most so many deviations: of the true reward of a step, averaged over an
    /// episode, from episode to episode, times the mean length of the two clips. 0 is exactly equal; for episodes that are all as
    /// long as each other, 1 is the standard deviation of their returns.
    pub tolerance: f64,
    /// Share of questions that they cannot answer, from 0 to 1.
    pub cannot_tell: f64,
}

/// What the answers of a simulated teacher go by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Says {
    /// The larger true return.
    #[default]
    TrueReturn,
    /// The smaller true return.
    Reversed,
    /// A coin, whatever the rewards are.
    Random,
    /// The first clip, always.
    First,
    /// A tie, always.
    Equal,
}

impl Says {
    /// Whether the answers go by true rewards.
    #[must_use]
    pub fn looks_at_rewards(self) -> bool {
        matches!(self, Self::TrueReturn | Self::Reversed)
    }

    /// As it is written in a configuration.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::TrueReturn => "true-return",
            Self::Reversed => "reversed",
            Self::Random => "random",
            Self::First => "first",
            Self::Equal => "equal",
        }
    }
}

impl TeacherConfig {
    /// Whether it is the one that knows the true rewards and never errs.
    #[must_use]
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// As a log names it: what answers go by, and every share that is not 0.
    #[must_use]
    pub fn name(&self) -> String {
        let mut name = format!("teacher:{}", self.says.name());
        for (field, value) in [
            ("errs", self.errs),
            ("tolerance", self.tolerance),
            ("cannot_tell", self.cannot_tell),
        ] {
            if value != 0.0 {
                name.push_str(&format!(",{field}={value}"));
            }
        }
        name
    }
}
