//! One run of a study, and what it came to: what every study of whole runs is made of.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::collect::CollectConfig;
use crate::config::Config;
use crate::doctor::processor;
use crate::evaluate::Evaluation;
use crate::fleet::Lane;
use crate::reward::quality::RewardQuality;
use crate::run::{DATASET, DatasetReference, EVALUATION, RunFolder, Spent};
use crate::train::RewardReport;

/// One run of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyRun {
    /// Its dataset, by the name that its score has.
    pub dataset: String,
    /// Where that is.
    pub place: PathBuf,
    /// How it is made if it is missing; none where that is somebody else's to do.
    pub collect: Option<CollectConfig>,
    /// Everything that decides what the run computes.
    pub config: Config,
    /// The folder of the run.
    pub folder: PathBuf,
}

/// What a finished run came to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunScore {
    /// The dataset as it was asked for.
    pub dataset: String,
    /// Digest of its arrays.
    pub dataset_digest: String,
    /// Everything that decided what the run computed.
    pub config: Config,
    /// How it flew.
    pub evaluation: Evaluation,
    /// What its rewards were worth; none where there is no reward.
    pub quality: Option<RewardQuality>,
    /// How long it took, if somebody looked at the clock.
    pub minutes: Option<f64>,
    /// The processor that its score was written down on.
    pub machine: String,
}

impl StudyRun {
    /// The run as a fleet makes it.
    pub(super) fn lane(&self) -> Lane {
        Lane {
            dataset: self.place.clone(),
            config: self.config.clone(),
            folder: self.folder.clone(),
            answers: None,
            siblings: Vec::new(),
        }
    }

    /// Whether this is its score.
    #[must_use]
    pub fn came_to(&self, score: &RunScore) -> bool {
        score.dataset == self.dataset && score.config == self.config
    }

    /// What its folder says, if it is finished and has flown as it was to fly.
    pub(super) fn read(&self) -> Option<RunScore> {
        if !RunFolder::holds(&self.folder, &self.config).ok()? {
            return None;
        }
        let folder = RunFolder::open(&self.folder).ok()?;
        let dataset: DatasetReference = folder.read_json(DATASET).ok()?;
        let reward: RewardReport = folder.read_json("reward.json").ok()?;
        let evaluation: Evaluation = folder.read_json(EVALUATION).ok()?;
        let flown = (evaluation.seed, evaluation.returns.len());
        let episodes = self.config.schedule.evaluation_episodes as usize;
        if flown != (self.config.seed, episodes) {
            return None;
        }
        // The time of a reward that was taken from another run is in it. Hundredths: nobody reads more.
        let minutes = |spent: Spent| (spent.reward_s + spent.policy_s) / 60.0;
        let minutes = Spent::of(&folder).map(|it| (100.0 * minutes(it)).round() / 100.0);
        Some(RunScore {
            dataset: self.dataset.clone(),
            dataset_digest: dataset.digest,
            config: self.config.clone(),
            evaluation,
            quality: reward.quality,
            minutes,
            machine: processor(),
        })
    }
}
