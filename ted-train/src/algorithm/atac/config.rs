//! Hyper-parameters of adversarially trained actor critic.

use serde::{Deserialize, Serialize};

use crate::nn::Adam;

/// Every number of the algorithm; the defaults are the original's, and beta the paper's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct AtacConfig {
    /// Gradient steps, those of the warm start included.
    pub steps: u64,
    /// Gradient steps of the warm start: the policy imitates, the critics judge what imitates.
    pub warm_start: u64,
    /// Transitions in a batch, drawn uniformly with replacement.
    pub batch: usize,
    /// Hidden widths of every network.
    pub hidden: Vec<usize>,
    /// Weight of the Bellman error against the pessimism.
    pub beta: f64,
    /// Step size of the critics, of alpha, and of the warm start.
    pub fast_rate: f64,
    /// Step size of the policy. Times the steps, it is how far a weight can go: fewer steps need a larger one.
    pub slow_rate: f64,
    /// Rate of the target networks' averaging.
    pub target_rate: f64,
    /// Largest Frobenius norm of a critic's weight matrix.
    pub norm_limit: f64,
    /// Smallest and largest standard deviation of the policy before tanh.
    pub std: [f64; 2],
    /// The optimiser's constants.
    pub adam: Adam,
}

impl Default for AtacConfig {
    fn default() -> Self {
        Self {
            steps: 1_100_000,
            warm_start: 100_000,
            batch: 256,
            hidden: vec![256, 256, 256],
            beta: 4.0,
            fast_rate: 5e-4,
            slow_rate: 5e-7,
            target_rate: 0.005,
            norm_limit: 100.0,
            std: [1e-5, 10.0],
            adam: Adam::default(),
        }
    }
}
