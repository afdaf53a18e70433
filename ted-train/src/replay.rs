//! The logs as a plant: what the controller would have done at every recorded observation.
//!
//! Nothing is simulated and nothing moves, so this is the last look before a policy drives a robot: would a range check stop
//! it on observations that the robot did see, how far are its actions from the recorded ones, and which of the episodes would
//! it call worth keeping?

use firmware_sim::controller::{Controller, Numeric};
use firmware_sim::interrupt;
use firmware_sim::plants::recording::{Recording, RecordingShape};
use firmware_sim::plants::replay::{Difference, ReplayError, ReplayPlant};
use firmware_sim::progress::Audience;
use firmware_sim::rollout::{FlyError, fly_episode};
use firmware_sim::scorer::EpisodeScorer;
use firmware_sim::scoring::{ScoreError, score_recording};
use serde::Serialize;
use ted_core::{DiscountClass, NEW_EPISODE};
use ted_policy::Artifact;

use crate::dataset::{Dataset, Episode};
use crate::evaluate::EpisodeFault;

/// What the controller did on a dataset.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Replayed {
    /// The dataset's id.
    pub dataset: String,
    /// Its episodes.
    pub episodes: usize,
    /// Their steps, of which each is a tick.
    pub ticks: u64,
    /// Ticks whose action was clamped into the contract's range.
    pub clamped_ticks: u64,
    /// Ticks whose action was held back by the slew limit.
    pub slew_limited_ticks: u64,
    /// The faults that were latched, at most one an episode.
    pub faults: Vec<EpisodeFault>,
    /// Where an action was farthest from the recorded one; `seed` is the episode's place in the dataset.
    pub largest_difference: Option<Difference>,
    /// Episodes in the top k % as the controller's scorer tells them; none if the artefact cannot score in these numbers.
    pub in_top_k: Option<usize>,
}

/// Why a dataset could not be shown to a policy.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
pub enum ReplayDatasetError {
    /// An episode does not fit together.
    Replay(#[from] ReplayError),
    /// The controller or the plant refused, or somebody asked to stop.
    Fly(#[from] FlyError),
    /// The scorer refused.
    Score(#[from] ScoreError),
}

/// Shows every observation of the dataset to the controller, on a clock that is never late, and every step to its scorer.
///
/// # Errors
/// When this machine does not compute the artefact's golden vectors, the shapes differ, or a stop is asked for.
pub fn replay(
    artifact: &Artifact<'_>,
    numeric: Numeric,
    dataset: &Dataset,
    audience: Audience,
) -> Result<Replayed, ReplayDatasetError> {
    let mut controller = Controller::load(artifact, numeric).map_err(FlyError::Load)?;
    let mut scorer = EpisodeScorer::load(artifact, numeric);
    let shape = RecordingShape {
        observation_dim: dataset.observation_dim(),
        action_dim: dataset.action_dim(),
        control_period_us: artifact.contract().control_period_us,
    };
    let mut replayed = Replayed {
        dataset: dataset.id().to_owned(),
        episodes: dataset.episodes().len(),
        ticks: 0,
        clamped_ticks: 0,
        slew_limited_ticks: 0,
        faults: Vec::new(),
        largest_difference: None,
        in_top_k: scorer.as_ref().map(|_| 0),
    };
    let progress = audience.start("replay the logs", replayed.episodes as u64, "episodes");
    for (number, episode) in dataset.episodes().iter().enumerate() {
        if interrupt::requested() {
            return Err(FlyError::Interrupted { flown: number }.into());
        }
        let seed = number as u64;
        let recording = recording(dataset, number, episode);
        if let (Some(scorer), Some(in_top_k)) = (&mut scorer, &mut replayed.in_top_k) {
            let place = u32::try_from(number).unwrap_or(NEW_EPISODE);
            let verdict = score_recording(scorer, shape, &recording, place)?;
            *in_top_k += usize::from(verdict.class == DiscountClass::TopK);
        }
        let mut plant = ReplayPlant::new(shape, vec![recording])?;
        let (report, _) = fly_episode(&mut controller, &mut plant, seed)
            .map_err(|source| FlyError::Episode { seed, source })?;
        replayed.ticks += u64::from(report.ticks);
        replayed.clamped_ticks += u64::from(report.clamped_ticks);
        replayed.slew_limited_ticks += u64::from(report.slew_limited_ticks);
        replayed.faults.extend(EpisodeFault::of(number, &report));
        let worst = |difference: &Option<Difference>| difference.map_or(-1.0, |d| d.absolute);
        let difference = plant.largest_difference();
        if worst(&difference) > worst(&replayed.largest_difference) {
            replayed.largest_difference = difference;
        }
        progress.advance(1);
    }
    progress.finish();
    Ok(replayed)
}

fn recording(dataset: &Dataset, number: usize, episode: &Episode) -> Recording {
    let steps = episode.first_step..episode.first_step + episode.len;
    let action = dataset.action_dim();
    Recording {
        seed: number as u64,
        // What the robot saw, and a controller would have.
        observations: dataset.observations_recorded(number),
        actions: dataset.actions_env()[steps.start * action..steps.end * action].to_vec(),
        rewards: dataset.rewards_true()[steps.clone()]
            .iter()
            .map(|&reward| f64::from(reward))
            .collect(),
        success: dataset.success()[steps].to_vec(),
    }
}
