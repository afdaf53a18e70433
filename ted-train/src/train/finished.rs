//! What a finished run learned: made at the end of training, or read back from the run's folder.

use std::path::PathBuf;

use firmware_sim::progress::Audience;
use ted_core::{RewardRange, TedDiscount};
use ted_policy::Digest;

use crate::algorithm::Replay;
use crate::algorithm::oppo::Oppo;
use crate::checkpoint::Checkpoint;
use crate::config::Config;
use crate::dataset::Dataset;
use crate::export::{Export, ExportError, Exported, artefact};
use crate::nn::{Backend, ExportedMlp};
use crate::reward::{ExportedEnsemble, Labels};
use crate::rng::Seed;
use crate::run::{RunError, RunFolder};

use super::TrainError;
use super::offline::{LearnedPolicy, NetworkPolicy};
use super::rewards::{self, Rewards};
use super::work::Work;

/// What came of a run.
pub enum Finished {
    /// An artefact, which a controller flies.
    Artefact(PathBuf),
    /// A sequence policy, which is in the last checkpoint and flies on this machine.
    Sequence(Box<Oppo>),
}

/// Everything that the artefact of a run is made from.
pub struct FinishedRun {
    pub(super) config: Config,
    pub(super) policy: NetworkPolicy,
    pub(super) rewards: Rewards,
    pub(super) ted: Option<TedDiscount>,
}

impl FinishedRun {
    /// Reads a run back from its folder: the last checkpoint and the reward ensemble. The dataset, which must be the one it
    /// was trained on, is labelled again.
    ///
    /// # Errors
    /// When the run has not made all of its updates, its policy is none that a controller flies, or one of its files cannot
    /// be used.
    pub fn read(
        folder: &RunFolder,
        dataset: &Dataset,
        audience: Audience,
    ) -> Result<Self, TrainError> {
        let config = Config::read(&folder.config_path()).map_err(RunError::from)?;
        // Before anybody is sent to finish a run that can never be exported.
        let not_for_controllers = || TrainError::NotForControllers {
            folder: folder.path().to_path_buf(),
            algorithm: config.algorithm.name(),
        };
        if !config.algorithm.makes_networks() {
            return Err(not_for_controllers());
        }
        let policy = match learned_policy(&config, folder, dataset, audience)? {
            LearnedPolicy::Network(policy) => policy,
            LearnedPolicy::Sequence(_) => return Err(not_for_controllers()),
        };
        let rewards = rewards::relabel(Work {
            dataset,
            config: &config,
            folder,
            audience,
        })?;
        let ted = config.discount.lookup(&rewards.labels.returns_hat)?;
        Ok(Self {
            config,
            policy,
            rewards,
            ted,
        })
    }

    /// Its artefact.
    ///
    /// # Errors
    /// When the controller could not run it, or a weight is not finite.
    pub fn artefact(&self, dataset: &Dataset) -> Result<Exported, ExportError> {
        artefact(&Export {
            dataset,
            shift: self.shift(),
            scale: self.scale(),
            actor: self.actor(),
            reward: self.reward(),
            // The controller's lookup is worth nothing to it without the ensemble's returns.
            ted: self.ted().map(|ted| (ted, &self.config.discount)),
            returns_hat: &self.labels().returns_hat,
            preset: self.config.preset.name(),
            seed: self.config.seed,
            steps: self.config.algorithm.steps(),
            config_digest: Digest(self.config.digest()),
            preferences_digest: self.rewards.preferences_digest,
        })
    }

    /// Its configuration.
    #[must_use]
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// The actor.
    #[must_use]
    pub fn actor(&self) -> &ExportedMlp {
        &self.policy.actor
    }

    /// Mean of each observation channel: subtracted first.
    #[must_use]
    pub fn shift(&self) -> &[f32] {
        &self.policy.shift
    }

    /// Inverse deviation of each observation channel: multiplied then.
    #[must_use]
    pub fn scale(&self) -> &[f32] {
        &self.policy.scale
    }

    /// The rewards that the policy was trained on.
    #[must_use]
    pub fn labels(&self) -> &Labels {
        &self.rewards.labels
    }

    /// The reward ensemble and its range, if the run learned one that a controller can compute.
    #[must_use]
    pub fn reward(&self) -> Option<(&ExportedEnsemble, RewardRange)> {
        let ensemble = self.rewards.model.as_ref()?.ensemble()?;
        self.for_the_controller((ensemble, self.rewards.labels.range))
    }

    /// TED's lookup, if the run used it on returns that a controller can compute.
    #[must_use]
    pub fn ted(&self) -> Option<TedDiscount> {
        self.for_the_controller(self.ted?)
    }

    /// The controller maps rewards to [0, 1]: it cannot repeat a learner that was given raw ones.
    fn for_the_controller<T>(&self, part: T) -> Option<T> {
        self.config.unit_rewards.then_some(part)
    }
}

/// The sequence policy of a finished run on this dataset; none where the policy is a network, which the artefact holds.
///
/// # Errors
/// When the run has not made all of its updates, or one of its files cannot be used.
pub fn sequence_policy(
    folder: &RunFolder,
    dataset: &Dataset,
    audience: Audience,
) -> Result<Option<Box<Oppo>>, TrainError> {
    let config = Config::read(&folder.config_path()).map_err(RunError::from)?;
    match learned_policy(&config, folder, dataset, audience)? {
        LearnedPolicy::Sequence(oppo) => Ok(Some(oppo)),
        LearnedPolicy::Network(_) => Ok(None),
    }
}

/// The policy of a finished run on this dataset.
fn learned_policy(
    config: &Config,
    folder: &RunFolder,
    dataset: &Dataset,
    audience: Audience,
) -> Result<LearnedPolicy, TrainError> {
    let checkpoint = last_checkpoint(folder, config, audience)?;
    let replay = Replay::new(dataset, Vec::new(), Vec::new()).seen(config.observations);
    // A network is numbers, whatever computed them; a sequence policy acts with what it was trained on, where there is that.
    let backend = match config.backend.usable() {
        Ok(()) => config.backend,
        Err(_) => Backend::default(),
    };
    let roots = [Seed::root(config.seed)];
    let mut learner = config.algorithm.learner(&[&replay], &roots, backend);
    learner.restore(&[&checkpoint]).map_err(RunError::from)?;
    let policy = learner.policies().swap_remove(0);
    Ok(LearnedPolicy::new(policy, &replay))
}

/// The checkpoint after the last update of a run.
///
/// # Errors
/// When there is none.
fn last_checkpoint(
    folder: &RunFolder,
    config: &Config,
    audience: Audience,
) -> Result<Checkpoint, TrainError> {
    let newest = folder.newest_checkpoint(config, audience);
    let step = newest.as_ref().map_or(0, |checkpoint| checkpoint.step);
    let steps = config.algorithm.steps();
    newest
        .filter(|checkpoint| checkpoint.step == steps)
        .ok_or_else(|| TrainError::NotFinished {
            folder: folder.path().to_path_buf(),
            step,
            steps,
        })
}

/// Updates that a run has made and saved.
#[must_use]
pub fn newest_step(folder: &RunFolder, config: &Config, audience: Audience) -> u64 {
    folder
        .newest_checkpoint(config, audience)
        .map_or(0, |checkpoint| checkpoint.step)
}
