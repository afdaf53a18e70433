//! Choices of the model of episodes.

use serde::{Deserialize, Serialize};

use crate::nn::Adam;

/// What is looked at before anybody is asked, what is asked, what is believed beforehand, and what is made of the answers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct EpisodesConfig {
    /// Questions that somebody is asked; none at all is allowed, and leaves what is believed beforehand.
    pub queries: usize,
    /// Principal directions of the places where an episode spends its time.
    pub directions: usize,
    /// Steps in a block: the two halves that a descriptor is compared between are made of every other block.
    pub block: usize,
    /// Mean weight of competence before anybody is asked, in standard deviations of quality for one of competence.
    pub competence: f64,
    /// How sure that is: its standard deviation.
    pub competence_std: f64,
    /// Standard deviation of the weight of each direction; its mean is 0.
    pub direction_std: f64,
    /// Largest distance of a channel or a descriptor from its mean that counts, in standard deviations.
    pub clip: f64,
    /// How steeply the chance of an answer rises with the difference in quality.
    pub slope: f64,
    /// Share of answers that say nothing.
    pub lapse: f64,
    /// Pairs among which a question is chosen.
    pub pool: usize,
    /// Episodes that each sample of the posterior holds to be the best.
    pub candidates: usize,
    /// Samples of the posterior.
    pub samples: usize,
    /// Updates between two samples, and a quarter of the updates before the first one.
    pub thinning: usize,
    /// How sure the improvement over the logs has to be for a policy to leave them, as a probability.
    pub sure: f64,
    /// How the logs are cloned, which competence is measured by.
    pub clone: Fitting,
    /// How the network is fitted that gives each transition its share of the quality.
    pub network: Fitting,
    /// Pairs held out to measure the agreement with true returns.
    pub held_out: usize,
}

/// How a network is fitted to what it has to repeat.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fitting {
    /// Hidden widths.
    pub hidden: Vec<usize>,
    /// Gradient steps.
    pub steps: u64,
    /// Transitions in a batch.
    pub batch: usize,
    /// Step size at the beginning; it falls to a hundredth along half a cosine.
    pub learning_rate: f64,
    /// The optimiser's constants.
    pub adam: Adam,
}

impl Default for EpisodesConfig {
    fn default() -> Self {
        Self {
            queries: 10,
            directions: 6,
            block: 10,
            competence: 2.0,
            competence_std: 1.0,
            direction_std: 0.5,
            clip: 4.0,
            slope: 2.0,
            lapse: 0.1,
            pool: 1000,
            candidates: 10,
            samples: 200,
            thinning: 5,
            sure: 0.8,
            clone: Fitting {
                hidden: vec![256, 256],
                steps: 6000,
                batch: 256,
                learning_rate: 1e-3,
                adam: Adam::default(),
            },
            network: Fitting {
                hidden: vec![64, 64],
                steps: 6000,
                batch: 256,
                learning_rate: 1e-3,
                adam: Adam::default(),
            },
            held_out: 1000,
        }
    }
}
