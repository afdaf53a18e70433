//! What a run is, how far it is, and what came of it.

use std::path::PathBuf;

use firmware_sim::progress::Audience;
use serde::Serialize;
use ted_policy::Digest;

use crate::config::Config;
use crate::evaluate::Evaluation;
use crate::run::{DATASET, DatasetReference, RunError, RunFolder, Spent};
use crate::train::{RewardReport, newest_step};

/// A run in short.
#[derive(Clone, Debug, Serialize)]
pub struct RunText {
    /// Its folder.
    pub path: PathBuf,
    /// The resolved configuration.
    pub config: Config,
    /// Digest of the configuration, as in the artefact.
    pub config_digest: String,
    /// The dataset that it is trained on.
    pub dataset: DatasetReference,
    /// Updates made and saved.
    pub step: u64,
    /// Updates asked for.
    pub steps: u64,
    /// The reward, if that phase is done.
    pub reward: Option<RewardReport>,
    /// Whether there is an artefact.
    pub artefact: Option<PathBuf>,
    /// How long it took, if somebody looked at the clock.
    pub spent: Option<Spent>,
    /// How the policy flew, if it has.
    pub evaluation: Option<Evaluation>,
    /// Files in the folder, with their sizes in bytes.
    pub files: Vec<(String, u64)>,
}

impl RunText {
    /// Reads what there is in the folder.
    ///
    /// # Errors
    /// When one of its files cannot be read.
    pub fn read(folder: &RunFolder) -> Result<Self, RunError> {
        let config = Config::read(&folder.config_path())?;
        let artefact = folder.artefact_path();
        let held = |name: &str| folder.file(name).is_file();
        Ok(Self {
            path: folder.path().to_path_buf(),
            config_digest: Digest(config.digest()).to_string(),
            dataset: folder.read_json(DATASET)?,
            step: newest_step(folder, &config, Audience::Nobody),
            steps: config.algorithm.steps(),
            reward: held("reward.json")
                .then(|| folder.read_json("reward.json"))
                .transpose()?,
            artefact: artefact.is_file().then_some(artefact),
            evaluation: held("evaluation.json")
                .then(|| folder.read_json("evaluation.json"))
                .transpose()?,
            spent: Spent::of(folder),
            files: files(folder),
            config,
        })
    }
}

fn files(folder: &RunFolder) -> Vec<(String, u64)> {
    let mut files: Vec<(String, u64)> = std::fs::read_dir(folder.path())
        .into_iter()
        .flatten()
        .flatten()
        .filter_map(|entry| {
            let size = entry.metadata().ok().filter(|data| data.is_file())?.len();
            Some((entry.file_name().into_string().ok()?, size))
        })
        .collect();
    files.sort();
    files
}
