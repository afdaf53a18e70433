//! The four phases of a run: learn a reward, label the data, set the discounts, learn a policy; then export it.

mod answers;
mod finished;
mod journal;
mod model;
mod offline;
mod prepared;
mod questions;
mod rewards;
mod watch;
mod work;

pub use finished::{Finished, FinishedRun, newest_step, sequence_policy};
pub use offline::{LearnedPolicy, NetworkPolicy, learn};
pub use prepared::Prepared;
pub use questions::{has_learned, questions};
pub use rewards::RewardReport;
pub use watch::Watch;

use std::path::PathBuf;

use crate::config::Config;
use crate::contract::contract;
use crate::dataset::Dataset;
use crate::export::ExportError;
use crate::filter::NothingKept;
use crate::need::{self, TooMuch};
use crate::nn::BackendError;
use crate::preferences::Teacher;
use crate::reward::transport::TransportError;
use crate::reward::{LearnError, Source};
use crate::run::{RunError, RunFolder};
use firmware_sim::disk::WriteError;

/// Why training stopped.
#[derive(Debug, thiserror::Error)]
pub enum TrainError {
    /// The run folder.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The disk.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The machine has not as much memory.
    #[error(transparent)]
    TooMuch(#[from] TooMuch),
    /// What it was to train on.
    #[error(transparent)]
    Backend(#[from] BackendError),
    /// The reward phase.
    #[error(transparent)]
    Learn(#[from] LearnError),
    /// Rewards to learn from that say nothing.
    #[error(
        "the true rewards of {id} are all {reward}, so a policy can learn nothing from them: choose a reward that is learned from answers, \
         such as --preset steer, and answer with --ask or --preferences"
    )]
    SameRewards {
        /// The dataset.
        id: String,
        /// The reward of every step.
        reward: f32,
    },
    /// Rewards by optimal transport.
    #[error(transparent)]
    Transport(#[from] TransportError),
    /// The filter.
    #[error(transparent)]
    Filter(#[from] NothingKept),
    /// The discounts.
    #[error(transparent)]
    Discount(#[from] ted_core::DiscountError),
    /// The export.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// Rewards that nothing can be learned from.
    #[error(
        "the rewards that were made for the transitions are not finite: a step size of the reward, or a number that it is multiplied by, \
         is too large"
    )]
    RewardsOverflow,
    /// A loss is no longer a number.
    #[error(
        "the {metric} is not finite after {step} updates: the learning rate or the rewards are too large"
    )]
    Diverged {
        /// Which number.
        metric: String,
        /// Updates made.
        step: u64,
    },
    /// There is nothing to export yet.
    #[error(
        "the run in {folder} has made {step} of {steps} updates: finish it with the same `ted train` command"
    )]
    NotFinished {
        /// The run's folder.
        folder: PathBuf,
        /// Updates made and saved.
        step: u64,
        /// Updates that the configuration asks for.
        steps: u64,
    },
    /// A policy that is no network from an observation to an action.
    #[error(
        "the policy of {folder} is a transformer over many steps ({algorithm}), and a controller flies networks that see one \
         observation: there is no artefact to export or to fly; `ted eval` flies the run from this machine"
    )]
    NotForControllers {
        /// The run's folder.
        folder: PathBuf,
        /// What learned it.
        algorithm: &'static str,
    },
    /// Somebody asked to stop.
    #[error("stopped after {step} updates; the same command goes on from there")]
    Interrupted {
        /// Updates made and saved.
        step: u64,
    },
}

/// Whether this configuration can be trained on this dataset, before anything is begun.
///
/// # Errors
/// When this build or this machine lacks the backend or the memory, when no controller could fly a policy for the dataset, or when it
/// has no segment as long as the questions ask for, too few episodes, or true rewards that are all the same where they are learned from.
pub fn check(dataset: &Dataset, config: &Config) -> Result<(), TrainError> {
    config.backend.usable()?;
    contract(dataset).map_err(ExportError::from)?;
    match config.reward.source() {
        Source::Computed(reward) => {
            refuse_no_rewards(dataset, reward.looks_at_rewards())?;
            reward.check(dataset)?;
        }
        Source::Learned(learner) => learner.check(dataset)?,
    }
    if let Some(questions) = config.algorithm.questions() {
        questions.check(dataset)?;
    }
    refuse_no_rewards(dataset, config.filter.looks_at_rewards())?;
    config.filter.check(dataset.episodes().len())?;
    Ok(need::check(dataset, config, 1)?)
}

/// Refuses rewards that are all the same where they are `needed`.
fn refuse_no_rewards(dataset: &Dataset, needed: bool) -> Result<(), TrainError> {
    match dataset.only_reward().filter(|_| needed) {
        Some(reward) => {
            let id = dataset.id().to_owned();
            Err(TrainError::SameRewards { id, reward })
        }
        None => Ok(()),
    }
}

/// Whether the simulated teacher can answer what a run of this configuration asks about this dataset, where nobody else does.
///
/// # Errors
/// When it cannot.
pub fn check_teacher(dataset: &Dataset, config: &Config) -> Result<(), TrainError> {
    if config.asks() {
        let teacher = config.simulated_teacher();
        teacher.check(dataset).map_err(LearnError::from)?;
    }
    Ok(())
}

/// Runs the phases of one run in order: [`Prepared::new`], [`learn`] and [`Prepared::finish`], which for many runs are called
/// one after the other too. The policy goes on from the newest checkpoint. The result is a function of the configuration, the
/// dataset and the answers.
///
/// # Errors
/// When [`check`] does, before anything is learned, and when a phase fails or is interrupted; what was finished is kept and
/// the same call goes on.
pub fn train(
    dataset: &Dataset,
    config: &Config,
    folder: &RunFolder,
    teacher: &mut dyn Teacher,
    watch: Watch<'_>,
) -> Result<(), TrainError> {
    let run = Prepared::new(dataset, config, folder, teacher, watch.audience())?;
    let mut learned = learn(&[&run], watch);
    run.finish(learned.swap_remove(0)?)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use firmware_sim::progress::Audience;

    use crate::config::Preset;
    use crate::dataset::{EpisodeRecord, Shape};
    use crate::preferences::ScriptedTeacher;
    use crate::run::DatasetReference;

    #[test]
    fn observations_that_no_controller_has_room_for_are_refused_before_anything_is_learned() {
        let shape = Shape {
            observation: ted_core::MAX_OBSERVATION + 1,
            action: 1,
        };
        let episode = EpisodeRecord {
            observations: vec![0.0; 3 * shape.observation],
            actions: vec![0.0; 2],
            rewards: vec![0.0; 2],
            terminations: vec![false; 2],
            truncations: vec![false, true],
            success: vec![false; 2],
            ..EpisodeRecord::default()
        };
        let dataset = Dataset::from_records("ted/x-v0", shape, &[episode]).unwrap();
        let reference = DatasetReference {
            id: dataset.id().to_owned(),
            digest: dataset.digest().to_owned(),
            path: PathBuf::new(),
        };
        let temporary = tempfile::tempdir().unwrap();
        let config = Preset::True.config();
        let folder = RunFolder::begin(temporary.path(), &config, &reference).unwrap();
        let mut teacher = ScriptedTeacher::truthful();
        let watch = Audience::Nobody.into();
        let refused = train(&dataset, &config, &folder, &mut teacher, watch);
        assert!(matches!(
            refused,
            Err(TrainError::Export(ExportError::Contract(_)))
        ));
        assert!(!folder.file("reward.json").exists());
    }
}
