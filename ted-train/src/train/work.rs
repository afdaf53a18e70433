//! What every phase of a run is told.

use firmware_sim::progress::Audience;

use crate::config::Config;
use crate::dataset::Dataset;
use crate::preferences::{Interview, PreferenceLog, Teacher};
use crate::reward::LearnError;
use crate::rng::Seed;
use crate::run::{PREFERENCES, RunFolder};

use super::TrainError;

/// A run at work.
#[derive(Clone, Copy)]
pub(super) struct Work<'a> {
    pub dataset: &'a Dataset,
    pub config: &'a Config,
    pub folder: &'a RunFolder,
    pub audience: Audience,
}

impl<'a> Work<'a> {
    /// Where everything random comes from.
    pub fn root(&self) -> Seed {
        Seed::root(self.config.seed)
    }

    /// Where everything random about rewards comes from, and about answers.
    pub fn reward_seed(&self) -> Seed {
        self.root().child("reward")
    }

    /// Begins to ask, or goes on with what the folder's log holds.
    pub fn interview(&self, teacher: &'a mut dyn Teacher) -> Result<Interview<'a>, TrainError> {
        let log = PreferenceLog::open(self.folder.file(PREFERENCES), self.dataset)
            .map_err(LearnError::from)?;
        if let Some(recovered) = log.recovered() {
            self.audience.note(&format!(
                "the preference log had a torn last line; {} answers are kept",
                recovered.kept
            ));
        }
        Ok(Interview::new(self.dataset, teacher, log))
    }
}
