//! Phases 1 and 2: learn the reward if the run has one to learn, and label the dataset.

use firmware_sim::progress::Audience;
use serde::{Deserialize, Serialize};
use ted_core::RewardRange;
use ted_policy::Digest;

use crate::config::Config;
use crate::dataset::Dataset;
use crate::export::ExportError;
use crate::preferences::{PreferenceLog, Teacher};
use crate::reward::oprl::{
    ExportedEnsemble, Fit, HeldOut, LearnError, OprlConfig, held_out_agreement, learn,
};
use crate::reward::quality::RewardQuality;
use crate::reward::transport::transport_labels;
use crate::reward::{
    Labels, RewardConfig, dataset_labels, ensemble_labels, negative_labels, random_labels,
    zero_labels,
};
use crate::rng::Seed;
use crate::run::{PREFERENCES, RunError, RunFolder};

use super::TrainError;

/// What `reward.json` says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RewardReport {
    /// Answers that were asked for.
    pub queries: usize,
    /// Fit of the training pairs after the first queries and after each round.
    pub fits: Vec<Fit>,
    /// Agreement on pairs that were not asked.
    pub held_out: Option<HeldOut>,
    /// Digest of the preference log.
    pub preferences_digest: Option<String>,
    /// Smallest raw reward of the dataset, which becomes 0.
    pub low: f32,
    /// Largest raw reward of the dataset, which becomes 1.
    pub high: f32,
    /// Agreement with the true rewards over the dataset.
    pub quality: RewardQuality,
}

/// The file of the trained ensemble.
const STATE: &str = "reward.state";

pub(super) struct Rewards {
    pub labels: Labels,
    pub ensemble: Option<ExportedEnsemble>,
    pub preferences_digest: Option<Digest>,
}

/// Rewards of every transition, and the ensemble they came from.
pub(super) fn rewards(
    dataset: &Dataset,
    config: &Config,
    folder: &RunFolder,
    teacher: &mut dyn Teacher,
    root: Seed,
    audience: Audience,
) -> Result<Rewards, TrainError> {
    let (rewards, facts) = label(dataset, config, root, audience, |oprl| {
        ensemble_of(oprl, dataset, config, folder, teacher, root, audience)
    })?;
    let report = RewardReport {
        queries: facts.queries,
        fits: facts.fits,
        held_out: facts.held_out,
        preferences_digest: facts.preferences_digest,
        low: rewards.labels.range.low,
        high: rewards.labels.range.high,
        quality: RewardQuality::measure(dataset, &rewards.labels),
    };
    folder.write_json("reward.json", &report)?;
    if matches!(config.reward, RewardConfig::Oprl(_)) {
        audience.note(&format!(
            "reward from {} answers: Spearman {:+.2} over episodes (lowest third {:+.2}, highest third {:+.2}), \
             Pearson {:+.2} over transitions",
            report.queries,
            report.quality.spearman,
            report.quality.spearman_low_third,
            report.quality.spearman_high_third,
            report.quality.transition_pearson,
        ));
    }
    Ok(rewards)
}

/// Rewards of every transition once more, from the ensemble that the folder of a finished run holds.
pub(super) fn relabel(
    dataset: &Dataset,
    config: &Config,
    folder: &RunFolder,
    audience: Audience,
) -> Result<Rewards, TrainError> {
    let held = |_: &OprlConfig| Ok(folder.read_state(STATE).map_err(RunError::from)?);
    let (rewards, _) = label(dataset, config, Seed::root(config.seed), audience, held)?;
    Ok(rewards)
}

/// Labels the dataset as the configuration says; `ensemble` is called for the one reward source that needs it.
fn label(
    dataset: &Dataset,
    config: &Config,
    root: Seed,
    audience: Audience,
    ensemble: impl FnOnce(&OprlConfig) -> Result<(ExportedEnsemble, EnsembleFacts), TrainError>,
) -> Result<(Rewards, EnsembleFacts), TrainError> {
    let (raw, learned) = match &config.reward {
        RewardConfig::True {} => (dataset_labels(dataset), None),
        RewardConfig::None {} | RewardConfig::Zero {} => (zero_labels(dataset), None),
        RewardConfig::Random {} => (random_labels(dataset, root.child("reward/random")), None),
        RewardConfig::Transport(config) => (transport_labels(dataset, config, audience)?, None),
        RewardConfig::Negative {} => (negative_labels(dataset), None),
        RewardConfig::Oprl(oprl) => {
            let (ensemble, facts) = ensemble(oprl)?;
            audience.note("label the dataset with the ensemble");
            let raw = ensemble
                .view(RewardRange {
                    low: 0.0,
                    high: 1.0,
                })
                .and_then(|view| ensemble_labels(dataset, &view))
                .map_err(ExportError::from)?;
            (raw, Some((ensemble, facts)))
        }
    };
    let (ensemble, facts) = learned.unzip();
    let labels = if config.unit_rewards {
        Labels::unit(raw)
    } else {
        Labels::raw(raw)
    };
    let facts = facts.unwrap_or_default();
    let preferences_digest = facts
        .preferences_digest
        .as_deref()
        .and_then(|digest| digest.parse().ok());
    let rewards = Rewards {
        labels,
        ensemble,
        preferences_digest,
    };
    Ok((rewards, facts))
}

/// What is known about an ensemble besides its weights.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct EnsembleFacts {
    queries: usize,
    fits: Vec<Fit>,
    held_out: Option<HeldOut>,
    preferences_digest: Option<String>,
}

/// The ensemble that the folder holds, or a newly learned one.
fn ensemble_of(
    oprl: &OprlConfig,
    dataset: &Dataset,
    config: &Config,
    folder: &RunFolder,
    teacher: &mut dyn Teacher,
    root: Seed,
    audience: Audience,
) -> Result<(ExportedEnsemble, EnsembleFacts), TrainError> {
    if folder.file(STATE).exists() {
        match folder.read_state(STATE) {
            Ok(state) => return Ok(state),
            Err(error) => audience.note(&format!("learning the reward again: {error}")),
        }
    }
    let mut log =
        PreferenceLog::open(folder.file(PREFERENCES), dataset).map_err(LearnError::from)?;
    if let Some(recovered) = log.recovered() {
        audience.note(&format!(
            "the preference log had a torn last line; {} answers are kept",
            recovered.kept
        ));
    }
    let learned = learn(
        oprl,
        dataset,
        teacher,
        &mut log,
        root.child("reward"),
        config.backend,
        audience,
    )?;
    let held_out = held_out_agreement(oprl, &learned.ensemble, dataset, root.child("reward"))
        .map_err(LearnError::from)?;
    let facts = EnsembleFacts {
        queries: log.entries().len(),
        fits: learned.fits,
        held_out: Some(held_out),
        preferences_digest: Some(log.digest().map_err(LearnError::from)?),
    };
    let state = (ExportedEnsemble::new(&learned.ensemble), facts);
    folder.write_state(STATE, &state)?;
    Ok(state)
}
