//! Phases 1 and 2: ask, learn the reward if the run has one to learn, and label the dataset.

use firmware_sim::progress::Audience;
use serde::{Deserialize, Serialize};
use ted_core::RewardRange;
use ted_policy::Digest;

use crate::algorithm::{AlgorithmConfig, metrics};
use crate::config::Config;
use crate::dataset::Dataset;
use crate::export::ExportError;
use crate::preferences::{LabelledPair, Teacher};
use crate::reward::oprl::ExportedEnsemble;
use crate::reward::quality::RewardQuality;
use crate::reward::transformer;
use crate::reward::transport::transport_labels;
use crate::reward::{
    Fit, HeldOut, Labels, RewardConfig, dataset_labels, ensemble_labels, negative_labels,
    random_labels, zero_labels,
};
use crate::rng::Seed;
use crate::run::{EventWriter, RunFolder};

use super::TrainError;
use super::answers::Answers;
use super::model::{self, Facts, RewardModel};

/// What `reward.json` says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RewardReport {
    /// Answers that were asked for.
    pub queries: usize,
    /// Fit of the training pairs: of an ensemble after the first queries and after each round, of a transformer after every
    /// [`transformer::LOOK_EVERY`] steps and at the end.
    pub fits: Vec<Fit>,
    /// Agreement on pairs that were not asked.
    pub held_out: Option<HeldOut>,
    /// Digest of the preference log.
    pub preferences_digest: Option<String>,
    /// Smallest raw reward of the dataset, which becomes 0.
    pub low: f32,
    /// Largest raw reward of the dataset, which becomes 1.
    pub high: f32,
    /// Agreement with the true rewards over the dataset; none where there is no reward.
    pub quality: Option<RewardQuality>,
}

pub(super) struct Rewards {
    pub labels: Labels,
    pub ensemble: Option<ExportedEnsemble>,
    /// Answers that the policy itself is learned from.
    pub answers: Vec<LabelledPair>,
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
    let (mut rewards, mut facts) = label(dataset, config, root, audience, || {
        model::learned(dataset, config, folder, teacher, root, audience)
    })?;
    if let AlgorithmConfig::Oppo(oppo) = &config.algorithm {
        (rewards.answers, facts) =
            Answers::of_a_policy(oppo, dataset, folder, teacher, root, audience)?;
    }
    let report = RewardReport {
        queries: facts.queries,
        fits: facts.fits,
        held_out: facts.held_out,
        preferences_digest: facts.preferences_digest,
        low: rewards.labels.range.low,
        high: rewards.labels.range.high,
        quality: match config.reward {
            RewardConfig::None {} => None,
            _ => Some(RewardQuality::measure(dataset, &rewards.labels)),
        },
    };
    folder.write_json("reward.json", &report)?;
    if !report.fits.is_empty() {
        curve(folder, config, &report.fits)?;
    }
    if let Some(quality) = report.quality.as_ref().filter(|_| report.queries > 0) {
        audience.note(&format!(
            "reward from {} answers: Spearman {:+.2} over episodes (lowest third {:+.2}, highest third {:+.2}), \
             Pearson {:+.2} over transitions",
            report.queries,
            quality.spearman,
            quality.spearman_low_third,
            quality.spearman_high_third,
            quality.transition_pearson,
        ));
    }
    Ok(rewards)
}

/// How a learned reward came to fit its answers, for TensorBoard.
fn curve(folder: &RunFolder, config: &Config, fits: &[Fit]) -> Result<(), TrainError> {
    let mut events = EventWriter::create(folder.path(), "reward")?;
    for (look, fit) in (1..).zip(fits) {
        let step = match &config.reward {
            RewardConfig::Transformer(it) => it.steps.min(look * transformer::LOOK_EVERY),
            _ => look - 1,
        };
        events.push("reward", step, &metrics(fit))?;
    }
    Ok(())
}

/// Rewards of every transition once more, from the model that the folder of a finished run holds.
pub(super) fn relabel(
    dataset: &Dataset,
    config: &Config,
    folder: &RunFolder,
    audience: Audience,
) -> Result<Rewards, TrainError> {
    let root = Seed::root(config.seed);
    let (rewards, _) = label(dataset, config, root, audience, || model::held(folder))?;
    Ok(rewards)
}

/// Labels the dataset as the configuration says; `model` is called for the sources that learn one.
fn label(
    dataset: &Dataset,
    config: &Config,
    root: Seed,
    audience: Audience,
    model: impl FnOnce() -> Result<(RewardModel, Facts), TrainError>,
) -> Result<(Rewards, Facts), TrainError> {
    let (mut ensemble, mut facts) = (None, Facts::default());
    let raw = match &config.reward {
        RewardConfig::True {} => dataset_labels(dataset),
        RewardConfig::None {} | RewardConfig::Zero {} => zero_labels(dataset),
        RewardConfig::Random {} => random_labels(dataset, root.child("reward/random")),
        RewardConfig::Negative {} => negative_labels(dataset),
        RewardConfig::Transport(config) => transport_labels(dataset, config, audience)?,
        RewardConfig::Oprl(_) | RewardConfig::Transformer(_) => {
            let (model, known) = model()?;
            facts = known;
            match model {
                RewardModel::Labels(raw) => raw,
                RewardModel::Ensemble(learned) => {
                    audience.note("label the dataset with the ensemble");
                    let raw = raw_labels(dataset, &learned)?;
                    ensemble = Some(learned);
                    raw
                }
            }
        }
    };
    let labels = if config.unit_rewards {
        Labels::unit(raw)
    } else {
        Labels::raw(raw)
    };
    let preferences_digest = facts
        .preferences_digest
        .as_deref()
        .and_then(|digest| digest.parse().ok());
    let rewards = Rewards {
        labels,
        ensemble,
        answers: Vec::new(),
        preferences_digest,
    };
    Ok((rewards, facts))
}

/// What the ensemble says of every transition, before its range is known.
fn raw_labels(dataset: &Dataset, ensemble: &ExportedEnsemble) -> Result<Vec<f32>, ExportError> {
    let range = RewardRange {
        low: 0.0,
        high: 1.0,
    };
    let view = ensemble.view(range)?;
    Ok(ensemble_labels(dataset, &view)?)
}
