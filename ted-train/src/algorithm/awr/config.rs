//! Hyper-parameters of advantage-weighted regression.

use serde::{Deserialize, Serialize};

/// Every number of the algorithm; the defaults are the original's, except for `steps`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct AwrConfig {
    /// Gradient steps, of V and of the policy together.
    pub steps: u64,
    /// Gradient steps of V in an iteration; at least 1.
    pub critic_steps: u64,
    /// Gradient steps of the policy after them.
    pub actor_steps: u64,
    /// Transitions in a batch, drawn uniformly with replacement.
    pub batch: usize,
    /// Hidden widths of both networks.
    pub hidden: Vec<usize>,
    /// Step size of V.
    pub critic_rate: f64,
    /// Step size of the policy.
    pub actor_rate: f64,
    /// Share of the last step that the next one keeps.
    pub momentum: f64,
    /// What the network of V is multiplied by: about as large as a value can be, 1 / (1 - 0.99).
    pub value_scale: f64,
    /// Share of the longer look ahead in a return, in [0, 1].
    pub lambda: f64,
    /// Temperature of the normalised advantages.
    pub temperature: f64,
    /// Largest weight of a transition.
    pub weight_clip: f64,
    /// Standard deviation of the policy.
    pub std: f64,
    /// Largest first weight of the policy's last layer.
    pub output_scale: f64,
}

impl Default for AwrConfig {
    fn default() -> Self {
        Self {
            steps: 150_000,
            critic_steps: 500,
            actor_steps: 1000,
            batch: 256,
            hidden: vec![128, 64],
            critic_rate: 1e-2,
            actor_rate: 5e-5,
            momentum: 0.9,
            value_scale: 100.0,
            lambda: 0.95,
            temperature: 1.0,
            weight_clip: 20.0,
            std: 0.2,
            output_scale: 0.01,
        }
    }
}
