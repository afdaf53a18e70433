//! Hyper-parameters of conditioned behaviour cloning.

use serde::{Deserialize, Serialize};

use crate::nn::{Adam, WarmupCosine};

/// Every number of the algorithm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ConditionedConfig {
    /// Gradient steps; also the horizon of the cosine.
    pub steps: u64,
    /// Transitions in a batch, drawn uniformly with replacement.
    pub batch: usize,
    /// Hidden widths of the trunk.
    pub hidden: Vec<usize>,
    /// Step size of the first update.
    pub learning_rate: f64,
    /// Step size towards the last update.
    pub final_rate: f64,
    /// Share of every weight that a step of size 1 would take away: logs are noisy, and the best of them few.
    pub weight_decay: f64,
    /// Share of the newest weights in the average that flies, once it is long.
    pub average_rate: f64,
    /// Episodes with the highest predicted returns, whose mean is condition 1.
    pub best: usize,
    /// The condition that the policy is flown at.
    pub aim: f64,
    /// Share of the gain that is flown: good episodes may go further than is good for a policy without their noise.
    pub haste: f64,
    /// The optimiser's constants.
    pub adam: Adam,
}

impl Default for ConditionedConfig {
    fn default() -> Self {
        Self {
            steps: 20_000,
            batch: 256,
            hidden: vec![256, 256],
            learning_rate: 1e-3,
            final_rate: 1e-5,
            weight_decay: 0.1,
            average_rate: 1e-3,
            best: 10,
            aim: 1.0,
            haste: 0.6,
            adam: Adam::default(),
        }
    }
}

impl ConditionedConfig {
    /// Step size before update `step` (from 0): half a cosine from `learning_rate` to `final_rate` over `steps`.
    #[must_use]
    pub fn rate(&self, step: u64) -> f64 {
        let cosine = WarmupCosine {
            start: self.learning_rate,
            peak: self.learning_rate,
            end: self.final_rate,
            warmup: 0.0,
        };
        cosine.rate(step, self.steps)
    }
}
