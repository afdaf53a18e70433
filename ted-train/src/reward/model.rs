//! What is left of a learned reward when the learner is gone: in the run's folder, and where it is small enough, in the
//! artefact.

use serde::{Deserialize, Serialize};
use ted_core::{RewardRange, ShapeError};

use crate::dataset::Dataset;

use super::{ExportedEnsemble, ensemble_labels};

/// What a learned source of rewards leaves.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum RewardModel {
    /// An ensemble, which a controller can compute too.
    Ensemble(ExportedEnsemble),
    /// The raw rewards of the dataset's transitions, by a model that no controller has room for.
    Labels(Vec<f32>),
}

impl RewardModel {
    /// What it says of every transition, before its range is known: of an ensemble, what `ted_core` computes.
    ///
    /// # Errors
    /// When a network is larger than the controller's limits, or of another shape than the dataset.
    pub fn raw_rewards(&self, dataset: &Dataset) -> Result<Vec<f32>, ShapeError> {
        match self {
            Self::Ensemble(ensemble) => {
                let range = RewardRange {
                    low: 0.0,
                    high: 1.0,
                };
                ensemble_labels(dataset, &ensemble.view(range)?)
            }
            Self::Labels(raw) => Ok(raw.clone()),
        }
    }

    /// What a controller can compute of it.
    #[must_use]
    pub fn ensemble(&self) -> Option<&ExportedEnsemble> {
        match self {
            Self::Ensemble(ensemble) => Some(ensemble),
            Self::Labels(_) => None,
        }
    }
}
