//! Phases 1 and 2: ask, learn the reward if the run has one to learn, and label the dataset.

use serde::{Deserialize, Serialize};
use ted_policy::Digest;

use crate::algorithm::metrics;
use crate::export::ExportError;
use crate::preferences::{LabelledPair, Teacher};
use crate::reward::episodes::Confidence;
use crate::reward::quality::RewardQuality;
use crate::reward::{Fit, HeldOut, Labels, RewardLearner, RewardModel, Source};
use crate::run::EventWriter;

use super::TrainError;
use super::answers;
use super::model::{self, Facts, State};
use super::work::Work;

/// What `reward.json` says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RewardReport {
    /// Answers that were asked for.
    pub queries: usize,
    /// Fit of the training pairs, every time that the learner looked: [`RewardLearner::looked_at`] says when.
    pub fits: Vec<Fit>,
    /// Agreement on pairs that were not asked; none where true rewards tell of no pair which is better.
    pub held_out: Option<HeldOut>,
    /// Digest of the preference log.
    pub preferences_digest: Option<String>,
    /// Smallest raw reward of the dataset, which becomes 0.
    pub low: f32,
    /// Largest raw reward of the dataset, which becomes 1.
    pub high: f32,
    /// Agreement with the true rewards over the dataset; none where there are none, or no reward that could agree.
    pub quality: Option<RewardQuality>,
    /// How sure it is that its best episodes are better than the logs; none of a reward that cannot tell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub confidence: Option<Confidence>,
}

pub(super) struct Rewards {
    pub labels: Labels,
    /// What they were learned as.
    pub model: Option<RewardModel>,
    /// Answers that the policy itself is learned from.
    pub answers: Vec<LabelledPair>,
    pub preferences_digest: Option<Digest>,
}

/// Rewards of every transition, and the model they came from.
pub(super) fn rewards(work: Work<'_>, teacher: &mut dyn Teacher) -> Result<Rewards, TrainError> {
    let (mut rewards, mut facts) = label(work, |learner| {
        let (model, facts) = model::learned(learner, work, teacher)?;
        curve(learner, work, &facts.fits)?;
        Ok((model, facts))
    })?;
    if let Some(questions) = work.config.algorithm.questions() {
        (rewards.answers, facts) = answers::of_a_policy(questions, work, teacher)?;
    }
    let there_is_one = !work.config.reward.is_none();
    let report = RewardReport {
        queries: facts.queries,
        fits: facts.fits,
        held_out: facts.held_out.filter(|it| it.pairs > 0),
        preferences_digest: facts.preferences_digest,
        low: rewards.labels.range.low,
        high: rewards.labels.range.high,
        quality: (there_is_one.then_some(&rewards.labels))
            .and_then(|labels| RewardQuality::measure(work.dataset, labels)),
        confidence: (rewards.model.as_ref()).and_then(|model| model.confidence().cloned()),
    };
    work.folder.write_json("reward.json", &report)?;
    if there_is_one && report.queries > 0 {
        let beside_the_truth = report.quality.as_ref().map_or_else(
            || "the logs have no rewards to compare it with".to_owned(),
            |quality| {
                format!(
                    "Spearman {:+.2} over episodes (lowest third {:+.2}, highest third {:+.2}), Pearson {:+.2} over transitions",
                    quality.spearman,
                    quality.spearman_low_third,
                    quality.spearman_high_third,
                    quality.transition_pearson,
                )
            },
        );
        work.audience.note(&format!(
            "reward from {} answers: {beside_the_truth}",
            report.queries
        ));
    }
    Ok(rewards)
}

/// How a learned reward came to fit its answers, for TensorBoard.
fn curve(learner: &dyn RewardLearner, work: Work<'_>, fits: &[Fit]) -> Result<(), TrainError> {
    if fits.is_empty() {
        return Ok(());
    }
    let mut events = EventWriter::create(work.folder.path(), "reward")?;
    for (index, fit) in (0..).zip(fits) {
        events.push("reward", learner.looked_at(index), &metrics(fit))?;
    }
    Ok(())
}

/// Rewards of every transition once more, from the model that the folder of a finished run holds.
pub(super) fn relabel(work: Work<'_>) -> Result<Rewards, TrainError> {
    let (rewards, _) = label(work, |_| model::held(work.folder))?;
    Ok(rewards)
}

/// Labels the dataset as the configuration says; `model` is called for the sources that learn one.
fn label(
    work: Work<'_>,
    model: impl FnOnce(&dyn RewardLearner) -> Result<State, TrainError>,
) -> Result<(Rewards, Facts), TrainError> {
    let (raw, model, facts) = match work.config.reward.source() {
        Source::Computed(reward) => {
            let raw = reward.raw_rewards(work.dataset, work.root(), work.audience)?;
            (raw, None, Facts::default())
        }
        Source::Learned(learner) => {
            let (model, facts) = model(learner)?;
            if model.ensemble().is_some() {
                work.audience.note("label the dataset with the ensemble");
            }
            let raw = model.raw_rewards(work.dataset);
            (raw.map_err(ExportError::from)?, Some(model), facts)
        }
    };
    if raw.iter().any(|reward| !reward.is_finite()) {
        return Err(TrainError::RewardsOverflow);
    }
    let labels = if work.config.unit_rewards {
        Labels::unit(work.dataset, raw)
    } else {
        Labels::raw(work.dataset, raw)
    };
    let preferences_digest = facts
        .preferences_digest
        .as_deref()
        .and_then(|digest| digest.parse().ok());
    let rewards = Rewards {
        labels,
        model,
        answers: Vec::new(),
        preferences_digest,
    };
    Ok((rewards, facts))
}
