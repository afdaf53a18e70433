//! The run's evaluation, flown again: the returns must have the same bits.

use firmware_sim::bridge::Engine;
use firmware_sim::progress::Audience;

use crate::evaluate::{Evaluation, FlightPlan, Flyer, evaluate};
use crate::run::{EVALUATION, RunFolder};

use super::CrosscheckError;

/// What flying the evaluation again came to.
pub(super) enum Again {
    /// Episodes compared, and those whose return differs.
    Compared((u64, u64)),
    /// Nothing was, and why.
    Nothing(&'static str),
}

/// Flies the first episodes of the run's evaluation again.
pub(super) fn fly_again(
    folder: &RunFolder,
    episodes: u32,
    workers: usize,
    audience: Audience,
) -> Result<Again, CrosscheckError> {
    if episodes == 0 {
        return Ok(Again::Nothing("not asked for"));
    }
    if !folder.file(EVALUATION).exists() {
        return Ok(Again::Nothing(
            "the run has no evaluation.json: `ted eval` makes one, with --world where its logs are of no world that is known here",
        ));
    }
    let held: Evaluation = folder.read_json(EVALUATION)?;
    let Some(world) = held.world() else {
        return Ok(Again::Nothing(
            "the world that evaluation.json was made in is not there any more",
        ));
    };
    let episodes = episodes.min(u32::try_from(held.returns.len()).unwrap_or(episodes));
    let flown = evaluate(
        Flyer::Artefact(&folder.artefact_path(), held.numeric),
        Some(world),
        &FlightPlan {
            episodes,
            seed: held.seed,
            workers,
            engine: Engine::default(),
        },
        audience,
    )?;
    if flown.never_flew() {
        return Ok(Again::Nothing(
            "a fault kept the policy from flying in every episode, so that any policy would return the same",
        ));
    }
    let different = flown
        .returns
        .iter()
        .zip(&held.returns)
        .filter(|(flown, held)| flown.to_bits() != held.to_bits())
        .count();
    Ok(Again::Compared((u64::from(episodes), different as u64)))
}
