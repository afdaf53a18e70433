//! Phase 1: the model of rewards that a run learns from answers, and keeps in its folder.

use firmware_sim::progress::Audience;
use serde::{Deserialize, Serialize};

use crate::config::Config;
use crate::dataset::Dataset;
use crate::preferences::{PreferenceLog, Teacher};
use crate::reward::oprl::{self, ExportedEnsemble, OprlConfig};
use crate::reward::transformer::{self, PtConfig, Saved, transformer_labels};
use crate::reward::{Fit, HeldOut, LearnError, RewardConfig};
use crate::rng::Seed;
use crate::run::{self, Clock, DATASET, DatasetReference, PREFERENCES, RunError, RunFolder, Spent};

use super::TrainError;
use super::answers::{self, Answers};

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
    let mut log = answers::log(folder, dataset, audience)?;
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
    let mut phase = Phase {
        dataset,
        config,
        folder,
        teacher,
        root,
        audience,
    };
    let state = match &config.reward {
        RewardConfig::Transformer(transformer) => phase.transformer(transformer, &mut log)?,
        RewardConfig::Oprl(oprl) => phase.ensemble(oprl, &mut log)?,
        _ => unreachable!("asked for by a source that learns nothing"),
    };
    folder.write_state(STATE, &state)?;
    // It is of no more use, and a run that finds it anyway does not look at it.
    let _ = std::fs::remove_file(folder.file(TRAINING));
    Ok(state)
}

/// A model as the folder keeps it.
type State = (RewardModel, Facts);

/// What both sources learn from.
struct Phase<'a> {
    dataset: &'a Dataset,
    config: &'a Config,
    folder: &'a RunFolder,
    teacher: &'a mut dyn Teacher,
    root: Seed,
    audience: Audience,
}

impl Phase<'_> {
    fn ensemble(
        &mut self,
        oprl: &OprlConfig,
        log: &mut PreferenceLog,
    ) -> Result<State, TrainError> {
        let (backend, seed) = (self.config.backend, self.root.child("reward"));
        let learned = oprl::learn(
            oprl,
            self.dataset,
            self.teacher,
            log,
            seed,
            backend,
            self.audience,
        )?;
        let held_out = oprl::held_out_agreement(oprl, &learned.ensemble, self.dataset, seed)
            .map_err(LearnError::from)?;
        let ensemble = ExportedEnsemble::new(&learned.ensemble);
        let facts = Facts {
            queries: log.entries().len(),
            fits: learned.fits,
            held_out: Some(held_out),
            preferences_digest: Some(log.digest().map_err(LearnError::from)?),
        };
        Ok((RewardModel::Ensemble(ensemble), facts))
    }

    fn transformer(
        &mut self,
        config: &PtConfig,
        log: &mut PreferenceLog,
    ) -> Result<State, TrainError> {
        let PtConfig {
            queries, segment, ..
        } = *config;
        let (dataset, teacher, root) = (self.dataset, &mut *self.teacher, self.root);
        let answers = Answers::ask(queries, segment, dataset, teacher, log, root)?;
        if let Some((sibling, state)) = self.of_a_sibling(&answers.digest) {
            let spent = Spent::of(&sibling).unwrap_or_default();
            let there = spent
                .reward_of
                .unwrap_or_else(|| sibling.path().to_path_buf());
            self.audience.note(&format!(
                "the reward of {} is this run's too",
                there.display()
            ));
            let spent = Spent {
                reward_s: spent.reward_s,
                policy_s: 0.0,
                reward_of: Some(there),
            };
            spent.write(self.folder)?;
            return Ok(state);
        }
        let saved = self.begun(&answers.digest);
        let clock = Clock::start(self.folder, run::Phase::Reward);
        let (folder, digest, seed) = (self.folder, &answers.digest, root.child("reward"));
        let learned = transformer::learn(
            config,
            dataset,
            &answers.pairs,
            seed,
            self.config.backend,
            saved,
            &mut |saved| {
                folder.write_state(TRAINING, &(digest, saved))?;
                clock.spent().write(folder)
            },
            self.audience,
        )?;
        let transformer = &learned.transformer;
        let held_out = transformer::held_out_agreement(config, transformer, dataset, seed)
            .map_err(LearnError::from)?;
        let raw = transformer_labels(dataset, transformer, self.audience)?;
        let facts = Facts {
            queries: log.entries().len(),
            fits: learned.fits,
            held_out: Some(held_out),
            preferences_digest: Some(answers.digest),
        };
        Ok((RewardModel::Labels(raw), facts))
    }

    /// What another run has learned that asked the same, was answered the same, and learns alike: it would come out the same
    /// here, to the bit.
    fn of_a_sibling(&self, answers: &str) -> Option<(RunFolder, State)> {
        self.folder.siblings().iter().find_map(|path| {
            // Whatever is amiss there, the reward is learned here.
            let sibling = RunFolder::open(path).ok()?;
            let config = Config::read(&sibling.config_path()).ok()?;
            let reference: DatasetReference = sibling.read_json(DATASET).ok()?;
            let alike = |of: &Config| (of.reward.clone(), of.seed, of.backend);
            if alike(&config) != alike(self.config) || reference.digest != self.dataset.digest() {
                return None;
            }
            let state: State = sibling.read_state(STATE).ok()?;
            let (_, facts) = &state;
            let same = facts.preferences_digest.as_deref() == Some(answers);
            same.then_some((sibling, state))
        })
    }

    /// A training that was stopped, if it was on these answers.
    fn begun(&self, answers: &str) -> Option<Saved> {
        if !self.folder.file(TRAINING).exists() {
            return None;
        }
        let why = match self.folder.read_state::<(String, Saved)>(TRAINING) {
            Ok((learned_from, saved)) if learned_from == answers => return Some(saved),
            Ok(_) => "what was learned so far is of other answers".to_owned(),
            Err(error) => error.to_string(),
        };
        let again = format!("learning the reward from its beginning: {why}");
        self.audience.note(&again);
        None
    }
}
