//! The four phases of a run: learn a reward, label the data, set the discounts, learn a policy; then export it.

mod offline;
mod rewards;

pub use offline::OfflineMetrics;
pub use rewards::RewardReport;

use firmware_sim::progress::Audience;
use ted_policy::Digest;

use crate::config::Config;
use crate::dataset::Dataset;
use crate::disk::{self, WriteError};
use crate::export::{Export, ExportError, artefact};
use crate::preferences::Teacher;
use crate::reward::oprl::LearnError;
use crate::rng::Seed;
use crate::run::{RunError, RunFolder};

/// Why training stopped.
#[derive(Debug, thiserror::Error)]
pub enum TrainError {
    /// The run folder.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The disk.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The reward phase.
    #[error(transparent)]
    Learn(#[from] LearnError),
    /// The discounts.
    #[error(transparent)]
    Discount(#[from] ted_core::DiscountError),
    /// The export.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// A loss is no longer a number.
    #[error(
        "the {network} loss is not finite after {step} updates: the learning rate or the rewards are too large"
    )]
    Diverged {
        /// Which network.
        network: &'static str,
        /// Updates made.
        step: u64,
    },
    /// Somebody asked to stop.
    #[error("stopped after {step} updates; the same command goes on from there")]
    Interrupted {
        /// Updates made and saved.
        step: u64,
    },
}

/// Runs every phase that the folder does not hold yet. The result is a function of the configuration and the dataset.
///
/// # Errors
/// When a phase fails or is interrupted; what was finished is kept and the same call goes on.
pub fn train(
    dataset: &Dataset,
    config: &Config,
    folder: &RunFolder,
    teacher: &mut dyn Teacher,
    audience: Audience,
) -> Result<(), TrainError> {
    let root = Seed::root(config.seed);

    // Phase 1 and 2: a reward for each transition.
    let rewards = rewards::rewards(dataset, config, folder, teacher, root, audience)?;
    let returns_hat = rewards.labels.episode_returns(dataset);

    // Phase 3: a discount for each transition.
    let ted = config.discount.lookup(&returns_hat)?;
    let discounts = config
        .discount
        .discounts(ted.as_ref(), dataset, &returns_hat);

    // Phase 4: a policy.
    let range = rewards.labels.range;
    let learned = offline::learn(
        dataset,
        config,
        folder,
        rewards.labels.rewards,
        discounts,
        root,
        audience,
    )?;

    let bytes = artefact(&Export {
        dataset,
        shift: &learned.shift,
        scale: &learned.scale,
        actor: &learned.actor,
        reward: rewards.ensemble.as_ref().map(|ensemble| (ensemble, range)),
        ted,
        preset: config.preset.name(),
        seed: config.seed,
        steps: config.iql.steps,
        config_digest: Digest(config.digest()),
        preferences_digest: rewards.preferences_digest,
    })?;
    disk::replace(&folder.artefact_path(), &bytes)?;
    Ok(())
}
