//! Choices of the Preference Transformer.

use serde::{Deserialize, Serialize};

use crate::nn::{AdamW, WarmupCosine};
use crate::reward::InputScaling;

/// How rewards of steps become the score of a clip.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RewardHead {
    /// Their mean: what the released code does unless a flag is set.
    PerStep,
    /// A mean with weights by attention among the steps, as the method's paper says.
    #[default]
    WeightedSum,
}

/// The transformer, its questions and its training.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PtConfig {
    /// Answers that a person has to give, each about a random pair.
    pub queries: usize,
    /// Steps of a clip, H; also how far back a reward looks.
    pub segment: u32,
    /// How observations are scaled; actions go in as they are.
    pub scaling: InputScaling,
    /// Numbers in a token, a multiple of `heads`.
    pub width: usize,
    /// Blocks.
    pub layers: usize,
    /// Heads of each block's attention.
    pub heads: usize,
    /// How rewards become a score.
    pub head: RewardHead,
    /// Share of numbers dropped in training.
    pub dropout: f64,
    /// Steps of the optimiser, each on all pairs.
    pub steps: u64,
    /// Step sizes.
    pub rate: WarmupCosine,
    /// The optimiser's constants.
    pub adamw: AdamW,
    /// Pairs held out to measure the agreement with true returns.
    pub held_out: usize,
}

impl Default for PtConfig {
    fn default() -> Self {
        Self {
            queries: 10,
            segment: 100,
            scaling: InputScaling::Standard { floor: 0.05 },
            width: 256,
            layers: 1,
            heads: 4,
            head: RewardHead::WeightedSum,
            dropout: 0.1,
            steps: 10_000,
            rate: WarmupCosine {
                start: 1e-4,
                peak: 1e-3,
                end: 1e-4,
                warmup: 0.1,
            },
            adamw: AdamW::default(),
            held_out: 1000,
        }
    }
}
