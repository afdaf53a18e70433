//! The controller's scorer on the logs, step by step, against the trainer's classes.

use firmware_sim::controller::Numeric;
use firmware_sim::scorer::EpisodeScorer;
use rayon::prelude::*;
use ted_core::{DiscountClass, NEW_EPISODE, ShapeError};
use ted_policy::Artifact;

use crate::dataset::{Dataset, Episode};

/// The class of every episode of the dataset as a controller scores it; none where the artefact cannot score.
pub(super) fn classes(
    artifact: &Artifact<'_>,
    numeric: Numeric,
    dataset: &Dataset,
) -> Result<Vec<DiscountClass>, ShapeError> {
    let Some(scorer) = EpisodeScorer::load(artifact, numeric) else {
        return Ok(Vec::new());
    };
    let score = |(number, episode): (usize, &Episode)| {
        let mut scorer = scorer.clone();
        for step in episode.first_step..episode.first_step + episode.len {
            scorer.push(dataset.observation(step), dataset.action_env(step))?;
        }
        Ok(scorer.class(u32::try_from(number).unwrap_or(NEW_EPISODE)))
    };
    dataset
        .episodes()
        .par_iter()
        .enumerate()
        .map(score)
        .collect()
}

/// Episodes compared, and those whose class differs or is missing on one side.
pub(super) fn unequal(scored: &[DiscountClass], trained: &[DiscountClass]) -> (u64, u64) {
    let unequal = scored.iter().zip(trained).filter(|(a, b)| a != b).count();
    let compared = scored.len().max(trained.len());
    (
        compared as u64,
        (unequal + scored.len().abs_diff(trained.len())) as u64,
    )
}
