//! The choice of an offline algorithm: what learns the policy from labelled transitions, and how.

use serde::{Deserialize, Serialize};

use crate::iql::IqlConfig;

/// Which offline algorithm learns the policy, with all of its numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum AlgorithmConfig {
    /// Implicit Q-learning.
    Iql(IqlConfig),
}

impl AlgorithmConfig {
    /// Gradient steps of a whole run.
    #[must_use]
    pub fn steps(&self) -> u64 {
        match self {
            Self::Iql(config) => config.steps,
        }
    }

    /// The same algorithm with another number of gradient steps.
    pub fn set_steps(&mut self, steps: u64) {
        match self {
            Self::Iql(config) => config.steps = steps,
        }
    }
}
