//! What follows from answers: the weights of the descriptors, the quality of the episodes, and how sure that is.

use nalgebra::{DMatrix, DVector};

use crate::ranking::ranking;

use super::confidence::Confidence;
use super::posterior::Evidence;
use super::{EpisodesConfig, Look};

/// What is believed after so many answers.
pub(super) struct Belief {
    /// The mean weight of each descriptor.
    pub weights: DVector<f64>,
    /// The quality of each episode by these weights.
    pub quality: DVector<f64>,
    pub confidence: Confidence,
}

impl Belief {
    /// From the answers, and samples of the weights after them.
    pub fn new(
        config: &EpisodesConfig,
        look: &Look<'_>,
        evidence: &Evidence,
        samples: &DMatrix<f64>,
    ) -> Self {
        let values = &look.descriptors().values;
        let weights: DVector<f64> = samples.row_mean().transpose();
        let quality = values * &weights;
        let mut best = ranking(quality.as_slice());
        best.truncate(config.candidates);
        let answers = [evidence.labels.len(), evidence.agreeing(&weights)];
        Self {
            confidence: Confidence::new(answers, samples, values, &best, config.sure),
            weights,
            quality,
        }
    }
}
