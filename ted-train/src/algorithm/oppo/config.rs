//! Choices of OPPO.

use serde::{Deserialize, Serialize};

use crate::nn::AdamW;

/// Both transformers, the latent, the questions and the training.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct OppoConfig {
    /// Answers that a person has to give, each about a random pair.
    pub queries: usize,
    /// Steps of a clip, K; also how far back the policy looks.
    pub segment: u32,
    /// Numbers in a token, a multiple of `heads`.
    pub width: usize,
    /// Blocks of each transformer.
    pub layers: usize,
    /// Heads of each block's attention.
    pub heads: usize,
    /// Numbers in the latent.
    pub latent: usize,
    /// Share of numbers dropped in training.
    pub dropout: f64,
    /// Clips from which the policy learns in an update.
    pub batch: usize,
    /// Updates.
    pub steps: u64,
    /// Step size of both transformers.
    pub learning_rate: f64,
    /// Updates for which the policy's step size rises.
    pub warmup: u64,
    /// Step size of the latent.
    pub latent_rate: f64,
    /// The optimiser's constants.
    pub adamw: AdamW,
    /// Weight of the preferences in the encoder's loss.
    pub preference_weight: f64,
    /// Weight of the latents' length in the encoder's loss.
    pub norm_weight: f64,
    /// How much nearer the better clip is asked to be.
    pub margin: f32,
    /// Deviation of the noise on standardised observations.
    pub noise: f32,
    /// Largest length of a network's gradient.
    pub clip: f32,
}

impl Default for OppoConfig {
    fn default() -> Self {
        Self {
            queries: 10,
            segment: 100,
            width: 128,
            layers: 3,
            heads: 2,
            latent: 16,
            dropout: 0.1,
            batch: 64,
            steps: 100_000,
            learning_rate: 1e-4,
            warmup: 10_000,
            latent_rate: 1e-2,
            adamw: AdamW::default(),
            preference_weight: 10.0,
            norm_weight: 0.1,
            margin: 1.0,
            noise: 0.1,
            clip: 0.25,
        }
    }
}
