//! One reward for each transition of a dataset, mapped to [0, 1].

use rayon::prelude::*;
use ted_core::{EpisodeReturn, RewardEnsemble, RewardRange, Scratch, ShapeError};

use crate::dataset::Dataset;

/// Rewards of a dataset as the learner sees them, and what they come to.
#[derive(Clone, Debug, PartialEq)]
pub struct Labels {
    /// One reward for each transition, in [0, 1] when mapped.
    pub rewards: Vec<f32>,
    /// The raw rewards that became 0 and 1.
    pub range: RewardRange,
    /// Predicted return of each episode: the sum that the device keeps, in its order and precision.
    pub returns_hat: Vec<f32>,
}

impl Labels {
    /// Maps raw rewards to [0, 1] by their smallest and largest value over the dataset.
    #[must_use]
    pub fn unit(dataset: &Dataset, raw: Vec<f32>) -> Self {
        let low = raw.iter().copied().fold(f32::INFINITY, f32::min);
        let high = raw.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let range = RewardRange { low, high };
        let rewards = raw.into_par_iter().map(|r| range.reward_hat(r)).collect();
        Self::new(dataset, rewards, range)
    }

    /// Leaves raw rewards as they are. TED then inverts where values are negative; a test shows it.
    #[must_use]
    pub fn raw(dataset: &Dataset, raw: Vec<f32>) -> Self {
        let range = RewardRange {
            low: 0.0,
            high: 1.0,
        };
        Self::new(dataset, raw, range)
    }

    fn new(dataset: &Dataset, rewards: Vec<f32>, range: RewardRange) -> Self {
        let sum = |rewards: &[f32]| {
            let mut total = EpisodeReturn::new();
            rewards.iter().for_each(|&r| total.push(r));
            total.return_hat()
        };
        let returns_hat = dataset
            .episodes()
            .iter()
            .map(|e| sum(&rewards[e.first_step..e.first_step + e.len]))
            .collect();
        Self {
            rewards,
            range,
            returns_hat,
        }
    }
}

/// The ensemble's raw reward of each transition, computed by the device's own kernel: what the controller will score is
/// to the bit what the learner was given.
///
/// # Errors
/// When the ensemble was not made for observations and actions of this size.
pub fn ensemble_labels(
    dataset: &Dataset,
    ensemble: &RewardEnsemble<'_>,
) -> Result<Vec<f32>, ShapeError> {
    let episode = |e: &crate::dataset::Episode| -> Result<Vec<f32>, ShapeError> {
        let mut scratch = Scratch::new();
        (e.first_step..e.first_step + e.len)
            .map(|step| {
                ensemble.raw(
                    dataset.observation(step),
                    dataset.action(step),
                    &mut scratch,
                )
            })
            .collect()
    };
    let episodes: Vec<Vec<f32>> = dataset
        .episodes()
        .par_iter()
        .map(episode)
        .collect::<Result<_, _>>()?;
    Ok(episodes.concat())
}
