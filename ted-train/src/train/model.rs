//! Phase 1: the model of rewards that a run learns from answers, and keeps in its folder.

use firmware_sim::progress::Audience;
use serde::{Deserialize, Serialize};

use crate::config::Config;
use crate::dataset::Dataset;
use crate::preferences::{PreferenceLog, Teacher};
use crate::reward::oprl::{self, ExportedEnsemble, Fit, HeldOut, OprlConfig};
use crate::reward::transformer::{self, PtConfig, transformer_labels};
use crate::reward::{RewardConfig, oprl::LearnError};
use crate::rng::Seed;
use crate::run::{Checkpoint, PREFERENCES, RunError, RunFolder};

use super::TrainError;

/// The file of the learned model.
const STATE: &str = "reward.state";

/// The file of a training that takes long enough to be gone on with.
const TRAINING: &str = "reward.training";

/// What a learned source of rewards leaves.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) enum RewardModel {
    /// An ensemble, which a controller can compute too.
    Ensemble(ExportedEnsemble),
    /// The raw rewards of the dataset's transitions, by a model that no controller has room for.
    Labels(Vec<f32>),
}

/// What is known about a model besides its rewards.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Facts {
    pub queries: usize,
    pub fits: Vec<Fit>,
    pub held_out: Option<HeldOut>,
    pub preferences_digest: Option<String>,
}

/// The model that the folder holds.
pub(super) fn held(folder: &RunFolder) -> Result<(RewardModel, Facts), TrainError> {
    Ok(folder.read_state(STATE).map_err(RunError::from)?)
}

/// The model that the folder holds, or a newly learned one.
pub(super) fn learned(
    dataset: &Dataset,
    config: &Config,
    folder: &RunFolder,
    teacher: &mut dyn Teacher,
    root: Seed,
    audience: Audience,
) -> Result<(RewardModel, Facts), TrainError> {
    let mut log =
        PreferenceLog::open(folder.file(PREFERENCES), dataset).map_err(LearnError::from)?;
    if folder.file(STATE).exists() {
        match folder.read_state::<(RewardModel, Facts)>(STATE) {
            Ok((model, facts)) => {
                let answers = log.digest().map_err(LearnError::from)?;
                if facts.preferences_digest != Some(answers) {
                    let difference = format!(
                        "its reward was learned from other answers than {PREFERENCES} has now"
                    );
                    return Err(folder.other(difference).into());
                }
                return Ok((model, facts));
            }
            Err(error) => audience.note(&format!("learning the reward again: {error}")),
        }
    }
    if let Some(recovered) = log.recovered() {
        audience.note(&format!(
            "the preference log had a torn last line; {} answers are kept",
            recovered.kept
        ));
    }
    let mut phase = Phase {
        dataset,
        config,
        folder,
        teacher,
        seed: root.child("reward"),
        audience,
    };
    let (model, fits, held_out) = match &config.reward {
        RewardConfig::Transformer(transformer) => phase.transformer(transformer, &mut log)?,
        RewardConfig::Oprl(oprl) => phase.ensemble(oprl, &mut log)?,
        _ => unreachable!("asked for by a source that learns nothing"),
    };
    let facts = Facts {
        queries: log.entries().len(),
        fits,
        held_out: Some(held_out),
        preferences_digest: Some(log.digest().map_err(LearnError::from)?),
    };
    let state = (model, facts);
    folder.write_state(STATE, &state)?;
    // It is of no more use, and a run that finds it anyway does not look at it.
    let _ = std::fs::remove_file(folder.file(TRAINING));
    Ok(state)
}

type Learned = (RewardModel, Vec<Fit>, HeldOut);

/// What both sources learn from.
struct Phase<'a> {
    dataset: &'a Dataset,
    config: &'a Config,
    folder: &'a RunFolder,
    teacher: &'a mut dyn Teacher,
    seed: Seed,
    audience: Audience,
}

impl Phase<'_> {
    fn ensemble(
        &mut self,
        oprl: &OprlConfig,
        log: &mut PreferenceLog,
    ) -> Result<Learned, TrainError> {
        let backend = self.config.backend;
        let learned = oprl::learn(
            oprl,
            self.dataset,
            self.teacher,
            log,
            self.seed,
            backend,
            self.audience,
        )?;
        let held_out = oprl::held_out_agreement(oprl, &learned.ensemble, self.dataset, self.seed)
            .map_err(LearnError::from)?;
        let ensemble = ExportedEnsemble::new(&learned.ensemble);
        Ok((RewardModel::Ensemble(ensemble), learned.fits, held_out))
    }

    fn transformer(
        &mut self,
        config: &PtConfig,
        log: &mut PreferenceLog,
    ) -> Result<Learned, TrainError> {
        let folder = self.folder;
        let answers = log.digest().map_err(LearnError::from)?;
        let saved = self.begun(&answers);
        let learned = transformer::learn(
            config,
            self.dataset,
            self.teacher,
            log,
            self.seed,
            self.config.backend,
            saved.as_ref(),
            &mut |answers, checkpoint| folder.write_state(TRAINING, &(answers, checkpoint)),
            self.audience,
        )?;
        let transformer = &learned.transformer;
        let held_out =
            transformer::held_out_agreement(config, transformer, self.dataset, self.seed)
                .map_err(transformer::LearnError::from)?;
        let raw = transformer_labels(self.dataset, transformer, self.audience)?;
        Ok((RewardModel::Labels(raw), vec![learned.fit], held_out))
    }

    /// A training that was stopped, if it was on these answers.
    fn begun(&self, answers: &str) -> Option<Checkpoint> {
        if !self.folder.file(TRAINING).exists() {
            return None;
        }
        let why = match self.folder.read_state::<(String, Checkpoint)>(TRAINING) {
            Ok((learned_from, saved)) if learned_from == answers => return Some(saved),
            Ok(_) => "what was learned so far is of other answers".to_owned(),
            Err(error) => error.to_string(),
        };
        let again = format!("learning the reward from its beginning: {why}");
        self.audience.note(&again);
        None
    }
}
