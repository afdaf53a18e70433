//! What a dataset is and came to.

use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::dataset::Dataset;
use crate::dataset::minari::Origin;

/// A dataset in short.
#[derive(Clone, Debug, Serialize)]
pub struct DatasetText {
    /// Where it lies.
    pub path: PathBuf,
    /// `namespace/name-vN`.
    pub id: String,
    /// BLAKE3 of all arrays.
    pub digest: String,
    /// How it was collected, if this project did.
    pub origin: Option<Origin>,
    /// Episodes.
    pub episodes: usize,
    /// Steps of all episodes.
    pub steps: usize,
    /// Steps of the shortest and of the longest episode.
    pub episode_steps: [usize; 2],
    /// Numbers in an observation.
    pub observation_dim: usize,
    /// Numbers in an action.
    pub action_dim: usize,
    /// True returns; none where there are no rewards.
    pub returns: Option<Returns>,
    /// Share of episodes with success at some step.
    pub success: f64,
    /// Steps at which the task ended.
    pub terminations: usize,
    /// Steps at which only the recording ended.
    pub truncations: usize,
}

/// What the episodes of a dataset are worth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Returns {
    /// Mean true return.
    pub mean: f64,
    /// Smallest true return.
    pub min: f64,
    /// Largest true return: what scores are normalised by.
    pub max: f64,
}

impl DatasetText {
    /// Of the dataset at `path`.
    pub(crate) fn new(path: &Path, dataset: &Dataset) -> Self {
        let episodes = dataset.episodes();
        let lengths = || episodes.iter().map(|episode| episode.len);
        let returns = || episodes.iter().map(|episode| episode.return_true);
        let solved = episodes.iter().filter(|episode| episode.success).count();
        let set = |flags: &[bool]| flags.iter().filter(|flag| **flag).count();
        Self {
            path: path.to_path_buf(),
            id: dataset.id().to_owned(),
            digest: dataset.digest().to_owned(),
            origin: dataset.origin().cloned(),
            episodes: episodes.len(),
            steps: dataset.step_count(),
            episode_steps: [
                lengths().min().unwrap_or_default(),
                lengths().max().unwrap_or_default(),
            ],
            observation_dim: dataset.observation_dim(),
            action_dim: dataset.action_dim(),
            returns: dataset.only_reward().is_none().then(|| Returns {
                mean: dataset.mean_return_true(),
                min: returns().fold(f64::INFINITY, f64::min),
                max: dataset.max_return_true(),
            }),
            success: solved as f64 / episodes.len().max(1) as f64,
            terminations: set(dataset.terminations()),
            truncations: set(dataset.truncations()),
        }
    }
}
