//! Hyper-parameters of behaviour cloning.

use serde::{Deserialize, Serialize};

use crate::nn::Adam;

/// Every number of the algorithm; the defaults are the original's, except for `steps`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BcConfig {
    /// Gradient steps.
    pub steps: u64,
    /// Transitions in a batch, drawn uniformly with replacement.
    pub batch: usize,
    /// Hidden widths of the policy.
    pub hidden: Vec<usize>,
    /// Step size.
    pub learning_rate: f64,
    /// The optimiser's constants.
    pub adam: Adam,
}

impl Default for BcConfig {
    fn default() -> Self {
        Self {
            steps: 100_000,
            batch: 256,
            hidden: vec![256, 256],
            learning_rate: 3e-4,
            adam: Adam::default(),
        }
    }
}
