//! What is believed of the weights, before and after answers, as samples.
//!
//! ```text
//! quality of an episode   u_e = w . x_e                                x_e: its descriptors, clipped
//! beforehand              w ~ N(m, diag(s^2))
//! an answer               P(second better) = lapse / 2 + (1 - lapse) sigmoid(slope (u_second - u_first))
//! ```
//!
//! The samples are drawn by elliptical slice sampling (Murray, Adams and MacKay 2010), which has nothing to tune and no step
//! that can fail: ten answers leave a posterior that is often far from normal.

use nalgebra::{DMatrix, DVector};
use rand::RngExt;

use crate::rng::{Seed, standard_normal};

use super::EpisodesConfig;

/// Weights believed beforehand: each independent and normal.
#[derive(Clone, Debug)]
pub(super) struct Prior {
    pub mean: DVector<f64>,
    pub std: DVector<f64>,
}

impl Prior {
    /// What the configuration says, in proportion to how far each descriptor means something.
    pub fn new(config: &EpisodesConfig, reliability: &[f64]) -> Self {
        let mean = |j: usize| {
            if j == 0 {
                config.competence * reliability[0]
            } else {
                0.0
            }
        };
        let std = |j: usize| {
            let std = if j == 0 {
                config.competence_std
            } else {
                config.direction_std
            };
            std * reliability[j]
        };
        let count = reliability.len();
        Self {
            mean: DVector::from_fn(count, |j, _| mean(j)),
            std: DVector::from_fn(count, |j, _| std(j)),
        }
    }
}

/// What was said so far.
#[derive(Clone, Debug, Default)]
pub(super) struct Evidence {
    /// Descriptors of the second episode minus those of the first.
    pub differences: Vec<DVector<f64>>,
    /// Probability that the second one is better, as answered: 0, 1, or 0.5.
    pub labels: Vec<f64>,
}

impl Evidence {
    /// Adds an answer.
    pub fn push(&mut self, difference: DVector<f64>, label: f32) {
        self.differences.push(difference);
        self.labels.push(f64::from(label));
    }

    /// Answers, ties left out, that the weights would give too.
    pub fn agreeing(&self, weights: &DVector<f64>) -> usize {
        let said = self.differences.iter().zip(&self.labels);
        said.filter(|&(difference, &label)| {
            label != 0.5 && (weights.dot(difference) > 0.0) == (label > 0.5)
        })
        .count()
    }

    /// The places of the answers to which the weights give less than an even chance.
    pub fn slips(&self, weights: &DVector<f64>) -> Vec<usize> {
        let said = self.differences.iter().zip(&self.labels).enumerate();
        let slips =
            said.filter(|(_, (difference, label))| (*label - 0.5) * weights.dot(difference) < 0.0);
        slips.map(|(place, _)| place).collect()
    }

    /// Log-likelihood of weights.
    fn log_likelihood(&self, config: &EpisodesConfig, weights: &DVector<f64>) -> f64 {
        let said = self.differences.iter().zip(&self.labels);
        let log = said.map(|(difference, &label)| {
            let p = second_better(config, weights.dot(difference));
            label * p.ln() + (1.0 - label) * (1.0 - p).ln()
        });
        log.sum()
    }
}

/// The chance that the second of two episodes is said to be better, by the difference in quality.
pub(super) fn second_better(config: &EpisodesConfig, difference: f64) -> f64 {
    let sure = 1.0 / (1.0 + (-config.slope * difference).exp());
    // Keeps logarithms finite where nobody ever lapses.
    (config.lapse / 2.0 + (1.0 - config.lapse) * sure).clamp(1e-12, 1.0 - 1e-12)
}

/// Samples of the weights, `[sample, descriptor]`, a function of the seed.
pub(super) fn posterior(
    config: &EpisodesConfig,
    prior: &Prior,
    evidence: &Evidence,
    seed: Seed,
) -> DMatrix<f64> {
    let mut rng = seed.rng();
    let count = prior.mean.len();
    let mut deviation = DVector::zeros(count);
    let likelihood =
        |deviation: &DVector<f64>| evidence.log_likelihood(config, &(&prior.mean + deviation));
    let mut current = likelihood(&deviation);
    let burn_in = config.samples * config.thinning / 4;
    let mut samples = DMatrix::zeros(config.samples, count);
    for update in 0..burn_in + config.samples * config.thinning {
        let other = DVector::from_fn(count, |j, _| prior.std[j] * standard_normal(&mut rng));
        let level = current + (1.0 - rng.random::<f64>()).ln();
        let mut angle = rng.random::<f64>() * std::f64::consts::TAU;
        let (mut low, mut high) = (angle - std::f64::consts::TAU, angle);
        loop {
            let moved = &deviation * angle.cos() + &other * angle.sin();
            let there = likelihood(&moved);
            // The bracket ends at where it is, which is above the level.
            if there > level || high - low < 1e-9 {
                (deviation, current) = (moved, there);
                break;
            }
            if angle < 0.0 {
                low = angle;
            } else {
                high = angle;
            }
            angle = low + (high - low) * rng.random::<f64>();
        }
        if let Some(kept) = update.checked_sub(burn_in)
            && kept % config.thinning == 0
        {
            let row = (&prior.mean + &deviation).transpose();
            samples.set_row(kept / config.thinning, &row);
        }
    }
    samples
}
