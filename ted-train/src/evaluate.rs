//! Evaluation: the artefact, flown by the controller in Meta-World. There is no second way to act.

use std::num::NonZeroUsize;
use std::path::Path;

use firmware_sim::bridge::environment::{self, SetupError};
use firmware_sim::interrupt;
use firmware_sim::plant::PlantError;
use firmware_sim::plants::metaworld::MetaWorldPlant;
use firmware_sim::progress::Audience;
use firmware_sim::rollout::{
    EpisodeReport, FlyError, Summary, episode_seeds, fly, normalised_score,
};
use firmware_sim::tasks::{self, TaskError};
use serde::{Deserialize, Serialize};
use ted_policy::{Artifact, ArtifactBytes, ArtifactError, LoadError};

/// How a policy flew.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    /// The task.
    pub task: String,
    /// Root of the episodes' seeds.
    pub seed: u64,
    /// True return of each episode.
    pub returns: Vec<f64>,
    /// Their mean.
    pub return_mean: f64,
    /// Their standard deviation.
    pub return_sd: f64,
    /// Mean return over the largest return of the dataset, the paper's score; none on another task than the dataset's.
    pub score: Option<f64>,
    /// Share of episodes with success at some step.
    pub success: f64,
    /// Episodes in which the controller latched a fault.
    pub faulted: usize,
    /// The faults.
    pub faults: Vec<EpisodeFault>,
    /// Mean true return of the dataset.
    pub dataset_mean: f64,
    /// Largest true return of the dataset.
    pub dataset_max: f64,
}

/// The fault that ended the policy's part in an episode.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct EpisodeFault {
    /// The episode's place among those that were flown.
    pub episode: usize,
    /// Ticks that the policy had flown before.
    pub tick: u32,
    /// The reason's number.
    pub code: u8,
    /// The reason.
    pub reason: String,
}

impl EpisodeFault {
    /// The fault of an episode, if it had one.
    #[must_use]
    pub fn of(episode: usize, report: &EpisodeReport) -> Option<Self> {
        let latched = report.fault?;
        Some(Self {
            episode,
            tick: latched.tick,
            code: latched.fault.code(),
            reason: latched.fault.to_string(),
        })
    }
}

impl Evaluation {
    /// Whether a fault kept the policy from flying a single tick of any episode.
    #[must_use]
    pub fn never_flew(&self) -> bool {
        self.faults.len() == self.returns.len() && self.faults.iter().all(|fault| fault.tick == 0)
    }
}

/// Why a policy could not be flown.
#[derive(Debug, thiserror::Error)]
pub enum EvaluateError {
    /// The artefact cannot be read.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The artefact is broken.
    #[error("the artefact is not valid: {0}")]
    Artifact(ArtifactError),
    /// The simulator has no such task.
    #[error(transparent)]
    Task(#[from] TaskError),
    /// There is no simulator.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The flight.
    #[error(transparent)]
    Fly(#[from] FlyError),
}

/// Flies `episodes` episodes whose seeds follow from `seed`; the number of workers changes nothing but the time.
///
/// # Errors
/// When the artefact is broken, there is no simulator, or a flight cannot be finished.
pub fn evaluate(
    artefact: &Path,
    task: Option<&str>,
    episodes: u32,
    seed: u64,
    workers: usize,
    audience: Audience,
) -> Result<Evaluation, EvaluateError> {
    let bytes = ArtifactBytes::read(artefact)?;
    let artifact = Artifact::parse(&bytes).map_err(EvaluateError::Artifact)?;
    let trained_for = artifact.contract().task;
    let task = tasks::single(task.unwrap_or(trained_for))?;
    let environment = environment::ensure(audience)?;
    let progress = audience.start(&format!("fly {task}"), u64::from(episodes), "episodes");
    let flight = fly(
        &artifact,
        || MetaWorldPlant::new(&environment, task).map_err(PlantError::link),
        &episode_seeds(seed, episodes as usize),
        NonZeroUsize::new(workers).unwrap_or(NonZeroUsize::MIN),
        interrupt::requested,
        |_| progress.advance(1),
    )?;
    progress.finish();
    let summary = Summary::of(&flight.episodes);
    let provenance = artifact.provenance();
    Ok(Evaluation {
        task: task.to_owned(),
        seed,
        returns: flight.episodes.iter().map(|e| e.return_true).collect(),
        return_mean: summary.return_mean,
        return_sd: summary.return_sd,
        // The best return of one task's dataset measures no other task.
        score: normalised_score(summary.return_mean, provenance.dataset_return_max)
            .filter(|_| task == trained_for),
        success: summary.success_rate,
        faulted: summary.faulted,
        faults: flight
            .episodes
            .iter()
            .enumerate()
            .filter_map(|(episode, report)| EpisodeFault::of(episode, report))
            .collect(),
        dataset_mean: provenance.dataset_return_mean,
        dataset_max: provenance.dataset_return_max,
    })
}
