//! What is left of a learned reward when the learner is gone: in the run's folder, and where it is small enough, in the
//! artefact.

use serde::{Deserialize, Serialize};
use ted_core::{RewardRange, ShapeError};

use crate::dataset::Dataset;

use super::episodes::{Confidence, EpisodeModel};
use super::{ExportedEnsemble, ensemble_labels};

/// What a learned source of rewards leaves.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum RewardModel {
    /// An ensemble, which a controller can compute too.
    Ensemble(ExportedEnsemble),
    /// The raw rewards of the dataset's transitions, by a model that no controller has room for.
    Labels(Vec<f32>),
    /// A model of whole episodes, with a network that a controller can compute.
    Episodes(EpisodeModel),
}

impl RewardModel {
    /// What it says of every transition, before its range is known: of an ensemble, what `ted_core` computes.
    ///
    /// # Errors
    /// When a network is larger than the controller's limits, or of another shape than the dataset.
    pub fn raw_rewards(&self, dataset: &Dataset) -> Result<Vec<f32>, ShapeError> {
        let ensemble = match self {
            Self::Ensemble(ensemble) => ensemble,
            Self::Episodes(model) => &model.network,
            Self::Labels(raw) => return Ok(raw.clone()),
        };
        let range = RewardRange {
            low: 0.0,
            high: 1.0,
        };
        ensemble_labels(dataset, &ensemble.view(range)?)
    }

    /// What a controller can compute of it.
    #[must_use]
    pub fn ensemble(&self) -> Option<&ExportedEnsemble> {
        match self {
            Self::Ensemble(ensemble) => Some(ensemble),
            Self::Episodes(model) => Some(&model.network),
            Self::Labels(_) => None,
        }
    }

    /// How good it holds each episode of the dataset to be; none of a model that knows transitions only.
    #[must_use]
    pub fn quality(&self) -> Option<&[f32]> {
        match self {
            Self::Episodes(model) => Some(&model.quality),
            Self::Ensemble(_) | Self::Labels(_) => None,
        }
    }

    /// How far a policy may go by it, from 0 for not at all to 1: all the way unless it says itself that it is not sure enough.
    #[must_use]
    pub fn trust(&self) -> f32 {
        match self.confidence() {
            Some(confidence) if !confidence.leaves_the_logs => 0.0,
            _ => 1.0,
        }
    }

    /// How sure it is that its best episodes are better than the logs; none of a model that cannot tell.
    #[must_use]
    pub fn confidence(&self) -> Option<&Confidence> {
        match self {
            Self::Episodes(model) => Some(&model.confidence),
            Self::Ensemble(_) | Self::Labels(_) => None,
        }
    }
}
