//! Choices of the optimal-transport reward.

use serde::{Deserialize, Serialize};

use crate::reward::InputScaling;

/// What it costs to carry one observation to another.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cost {
    /// One minus the cosine of the angle between them, in [0, 2]; 1/2 where one of them is zero and has no direction.
    #[default]
    Cosine,
    /// Their Euclidean distance, in the unit of the scaled observations.
    Euclidean,
}

/// Experts, cost, solver and squashing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TransportConfig {
    /// Episodes that are imitated: those with the highest true returns. From 1 to as many as there are.
    pub experts: usize,
    /// How observations are scaled before they are compared.
    pub scaling: InputScaling,
    /// How they are compared.
    pub cost: Cost,
    /// Weight of the plan's entropy, in the unit of the cost; above 0.
    pub epsilon: f64,
    /// Most iterations of Sinkhorn's algorithm for a pair of episodes; at least 1.
    pub iterations: u32,
    /// Reward of a step that costs nothing; above 0.
    pub alpha: f64,
    /// How fast the reward falls with the cost; above 0.
    pub beta: f64,
}

impl Default for TransportConfig {
    fn default() -> Self {
        Self {
            experts: 10,
            scaling: InputScaling::Raw {},
            cost: Cost::Cosine,
            epsilon: 0.01,
            iterations: 100,
            alpha: 5.0,
            beta: 5.0,
        }
    }
}
