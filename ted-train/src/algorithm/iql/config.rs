//! Hyper-parameters of implicit Q-learning.

use serde::{Deserialize, Serialize};

use crate::nn::Adam;

/// Every number of the algorithm; the defaults are the original's, except for `steps`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct IqlConfig {
    /// Gradient steps; also the horizon of the actor's cosine schedule.
    pub steps: u64,
    /// Transitions in a batch, drawn uniformly with replacement.
    pub batch: usize,
    /// Hidden widths of every network.
    pub hidden: Vec<usize>,
    /// Expectile of the value loss, in (0, 1).
    pub tau: f64,
    /// Inverse temperature of the advantage weights.
    pub beta: f64,
    /// Largest advantage weight.
    pub advantage_clip: f64,
    /// Step size of all four networks; the actor's follows a cosine to 0.
    pub learning_rate: f64,
    /// Rate of the target networks' averaging.
    pub target_rate: f64,
    /// Lower and upper end of the policy's log standard deviation.
    pub log_std: [f64; 2],
    /// The optimiser's constants.
    pub adam: Adam,
}

impl Default for IqlConfig {
    fn default() -> Self {
        Self {
            steps: 100_000,
            batch: 256,
            hidden: vec![256, 256],
            tau: 0.7,
            beta: 3.0,
            advantage_clip: 100.0,
            learning_rate: 3e-4,
            target_rate: 0.005,
            log_std: [-5.0, 2.0],
            adam: Adam::default(),
        }
    }
}

impl IqlConfig {
    /// The actor's step size before update `step` (from 0): cosine from `learning_rate` to 0 over `steps`.
    #[must_use]
    pub fn actor_rate(&self, step: u64) -> f64 {
        let progress = (step as f64 / self.steps as f64).min(1.0);
        self.learning_rate * 0.5 * (1.0 + (std::f64::consts::PI * progress).cos())
    }
}
