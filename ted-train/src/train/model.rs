//! Phase 1: the model of rewards that a run learns from answers, and keeps in its folder.

use serde::{Deserialize, Serialize};

use crate::config::Config;
use crate::preferences::{Interview, Teacher};
use crate::reward::{Fit, HeldOut, LearnError, Material, RewardLearner, RewardModel, Saved};
use crate::run::{
    Clock, DATASET, DatasetReference, PREFERENCES, Phase, RunError, RunFolder, Spent,
};

use super::TrainError;
use super::work::Work;

/// The file of the learned model.
pub(super) const STATE: &str = "reward.state";

/// The file of a training that takes long enough to be gone on with.
const TRAINING: &str = "reward.training";

/// What is known about a model besides its rewards.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Facts {
    pub queries: usize,
    pub fits: Vec<Fit>,
    pub held_out: Option<HeldOut>,
    pub preferences_digest: Option<String>,
}

/// A model as the folder keeps it.
pub(super) type State = (RewardModel, Facts);

/// The model that the folder holds.
pub(super) fn held(folder: &RunFolder) -> Result<State, TrainError> {
    Ok(folder.read_state(STATE).map_err(RunError::from)?)
}

/// The model that the folder holds, or that of another run that learns the same, or a newly learned one.
pub(super) fn learned(
    learner: &dyn RewardLearner,
    work: Work<'_>,
    teacher: &mut dyn Teacher,
) -> Result<State, TrainError> {
    let mut interview = work.interview(teacher)?;
    if let Some(state) = kept(work, &mut interview)? {
        return Ok(state);
    }
    let on = Material {
        dataset: work.dataset,
        seed: work.reward_seed(),
        backend: work.config.backend,
        audience: work.audience,
    };
    let answers = learner.ask(on, &mut interview)?;
    let digest = interview.digest().map_err(LearnError::from)?;
    let state = match of_a_sibling(work, &digest)? {
        Some(state) => state,
        None => {
            let clock = Clock::start(work.folder, Phase::Reward);
            let save = &mut |saved: &Saved| {
                work.folder.write_state(TRAINING, &(&digest, saved))?;
                clock.spent().write(work.folder)
            };
            let learned = match begun(work, &digest) {
                Some(saved) => learner.resume(saved, &answers, on, &mut interview, save),
                None => learner.learn(&answers, on, &mut interview, save),
            }?;
            let facts = Facts {
                queries: interview.answered(),
                fits: learned.fits,
                held_out: Some(learned.held_out),
                preferences_digest: Some(interview.digest().map_err(LearnError::from)?),
            };
            (learned.model, facts)
        }
    };
    work.folder.write_state(STATE, &state)?;
    // It is of no more use, and a run that finds it anyway does not look at it.
    let _ = std::fs::remove_file(work.folder.file(TRAINING));
    Ok(state)
}

/// What the folder holds, if it can be read and was learned from the answers of its log.
fn kept(work: Work<'_>, interview: &mut Interview<'_>) -> Result<Option<State>, TrainError> {
    if !work.folder.file(STATE).exists() {
        return Ok(None);
    }
    let (model, facts) = match work.folder.read_state::<State>(STATE) {
        Ok(state) => state,
        Err(error) => {
            let again = format!("learning the reward again: {error}");
            work.audience.note(&again);
            return Ok(None);
        }
    };
    let answers = interview.digest().map_err(LearnError::from)?;
    if facts.preferences_digest != Some(answers) {
        let difference =
            format!("its reward was learned from other answers than {PREFERENCES} has now");
        return Err(work.folder.other(difference).into());
    }
    Ok(Some((model, facts)))
}

/// What another run has learned that asked the same, was answered the same, and learns alike: it would come out the same
/// here, to the bit. What it cost there is what this run's reward has cost.
fn of_a_sibling(work: Work<'_>, answers: &str) -> Result<Option<State>, TrainError> {
    let found = work.folder.siblings().iter().find_map(|path| {
        // Whatever is amiss there, the reward is learned here.
        let sibling = RunFolder::open(path).ok()?;
        let config = Config::read(&sibling.config_path()).ok()?;
        let reference: DatasetReference = sibling.read_json(DATASET).ok()?;
        let alike = |of: &Config| (of.reward.clone(), of.seed, of.backend);
        if alike(&config) != alike(work.config) || reference.digest != work.dataset.digest() {
            return None;
        }
        let state: State = sibling.read_state(STATE).ok()?;
        let same = state.1.preferences_digest.as_deref() == Some(answers);
        same.then_some((sibling, state))
    });
    let Some((sibling, state)) = found else {
        return Ok(None);
    };
    let spent = Spent::of(&sibling).unwrap_or_default();
    let there = spent
        .reward_of
        .unwrap_or_else(|| sibling.path().to_path_buf());
    work.audience.note(&format!(
        "the reward of {} is this run's too",
        there.display()
    ));
    let spent = Spent {
        reward_s: spent.reward_s,
        policy_s: 0.0,
        reward_of: Some(there),
    };
    spent.write(work.folder)?;
    Ok(Some(state))
}

/// A training that was stopped, if it was on these answers.
fn begun(work: Work<'_>, answers: &str) -> Option<Saved> {
    if !work.folder.file(TRAINING).exists() {
        return None;
    }
    let why = match work.folder.read_state::<(String, Saved)>(TRAINING) {
        Ok((learned_from, saved)) if learned_from == answers => return Some(saved),
        Ok(_) => "what was learned so far is of other answers".to_owned(),
        Err(error) => error.to_string(),
    };
    let again = format!("learning the reward from its beginning: {why}");
    work.audience.note(&again);
    None
}
