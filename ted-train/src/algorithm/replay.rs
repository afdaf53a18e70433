//! What a learner learns from, and drawing batches of it: uniform with replacement over the kept transitions, straight from
//! the dataset's arrays.

use rand::RngExt;
use serde::{Deserialize, Serialize};

use crate::dataset::Dataset;
use crate::filter::Kept;
use crate::preferences::LabelledPair;
use crate::rng::Seed;

use super::{Batch, Conditions};

#[cfg(test)]
mod tests;

/// How a learner and its policy see observations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ObservationScaling {
    /// Minus the dataset's mean, divided by its standard deviation.
    #[default]
    Standardised,
    /// As recorded, as the code that the paper builds on has it.
    Raw,
}

/// What a lane learns from: standardised observations, labelled rewards, a discount for each transition, how good its
/// episode is where the policy is told, and answers where it is learned from them.
pub struct Replay<'a> {
    dataset: &'a Dataset,
    shift: Vec<f32>,
    scale: Vec<f32>,
    rewards: Vec<f32>,
    discounts: Vec<f32>,
    kept: Kept,
    conditions: Conditions,
    answers: Vec<LabelledPair>,
}

/// The log-likelihood of an action at the edge of the range stays finite (`dataset_utils.py` of the original).
const ACTION_LIMIT: f32 = 1.0 - 1e-5;

impl<'a> Replay<'a> {
    /// Joins a dataset with its labels. All transitions may be drawn.
    #[must_use]
    pub fn new(dataset: &'a Dataset, rewards: Vec<f32>, discounts: Vec<f32>) -> Self {
        let statistics = dataset.observation_statistics();
        // The floor is added, so that a constant channel becomes zero instead of noise.
        let deviations = statistics.std.iter().zip(&statistics.floor);
        let scale = deviations.map(|(std, floor)| 1.0 / (std + floor)).collect();
        Self {
            dataset,
            shift: statistics.mean,
            scale,
            rewards,
            discounts,
            kept: Kept::all(dataset),
            conditions: Conditions::default(),
            answers: Vec::new(),
        }
    }

    /// Shows observations in this way; standardised if nobody says another.
    #[must_use]
    pub fn seen(mut self, scaling: ObservationScaling) -> Self {
        if scaling == ObservationScaling::Raw {
            self.shift.fill(0.0);
            self.scale.fill(1.0);
        }
        self
    }

    /// Draws from these transitions only. Observations stay standardised by the whole dataset.
    #[must_use]
    pub fn keep(self, kept: Kept) -> Self {
        Self { kept, ..self }
    }

    /// Adds how good the episode of each transition is.
    #[must_use]
    pub fn conditioned(self, conditions: Conditions) -> Self {
        Self { conditions, ..self }
    }

    /// Adds the answers that the policy itself is learned from.
    #[must_use]
    pub fn answered(self, answers: Vec<LabelledPair>) -> Self {
        Self { answers, ..self }
    }

    /// Mean of each observation channel: subtracted first.
    #[must_use]
    pub fn shift(&self) -> &[f32] {
        &self.shift
    }

    /// Inverse deviation of each observation channel: multiplied then.
    #[must_use]
    pub fn scale(&self) -> &[f32] {
        &self.scale
    }

    /// The dataset.
    #[must_use]
    pub fn dataset(&self) -> &Dataset {
        self.dataset
    }

    /// The reward of each transition.
    #[must_use]
    pub fn rewards(&self) -> &[f32] {
        &self.rewards
    }

    /// The discount of each transition.
    #[must_use]
    pub fn discounts(&self) -> &[f32] {
        &self.discounts
    }

    /// The transitions that batches are drawn from.
    #[must_use]
    pub fn kept(&self) -> &Kept {
        &self.kept
    }

    /// How far from the average of the logs towards its aim a conditioned policy may fly, in [0, 1].
    #[must_use]
    pub fn advance(&self) -> f32 {
        self.conditions.advance()
    }

    /// What was said about pairs of clips.
    #[must_use]
    pub fn answers(&self) -> &[LabelledPair] {
        &self.answers
    }

    /// Standardised observations of these rows of the dataset, `[row, observation]`.
    pub(crate) fn standardised(&self, rows: std::ops::Range<usize>) -> Vec<f32> {
        let width = self.dataset.observation_dim();
        let raw = &self.dataset.observations()[rows.start * width..rows.end * width];
        let mut out = Vec::with_capacity(raw.len());
        raw.chunks_exact(width)
            .for_each(|row| self.standardise(row, &mut out));
        out
    }

    /// Batch of update `step`: a function of the stream and the step, so that a resumed run goes on with the same ones.
    #[must_use]
    pub fn batch(&self, stream: Seed, step: u64, size: usize) -> Batch {
        let mut rng = stream.rng_at(step);
        let width = self.dataset.observation_dim();
        let mut batch = Batch {
            observations: Vec::with_capacity(size * width),
            next_observations: Vec::with_capacity(size * width),
            actions: Vec::with_capacity(size * self.dataset.action_dim()),
            rewards: Vec::with_capacity(size),
            discounts: Vec::with_capacity(size),
            transitions: Vec::with_capacity(size),
            conditions: Vec::new(),
        };
        for _ in 0..size {
            let step = self.kept.step(rng.random_range(0..self.kept.count()));
            self.standardise(self.dataset.observation(step), &mut batch.observations);
            self.standardise(
                self.dataset.next_observation(step),
                &mut batch.next_observations,
            );
            batch.actions.extend(
                self.dataset
                    .action(step)
                    .iter()
                    .map(|a| a.clamp(-ACTION_LIMIT, ACTION_LIMIT)),
            );
            batch.rewards.push(self.rewards[step]);
            batch.discounts.push(self.discounts[step]);
            // A dataset numbers its rows in 32 bits.
            batch.transitions.push(step as u32);
            batch.conditions.extend(self.conditions.of(step));
        }
        batch
    }

    /// `(raw - shift) * scale`, the arithmetic of [`ted_core::Normaliser`].
    fn standardise(&self, raw: &[f32], out: &mut Vec<f32>) {
        out.extend(
            raw.iter()
                .zip(&self.shift)
                .zip(&self.scale)
                .map(|((x, shift), scale)| (x - shift) * scale),
        );
    }
}
