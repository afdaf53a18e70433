//! Where a policy comes from.

use serde::{Deserialize, Serialize};

use crate::digest::Digest;

/// Where a policy comes from: enough to train it again and to compare its score.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Provenance<'a> {
    /// Version of the trainer.
    pub trainer_version: &'a str,
    /// The method, such as `oprl-i+ted`.
    pub preset: &'a str,
    /// Root seed of the run.
    pub seed: u64,
    /// Gradient steps of the policy.
    pub steps: u64,
    /// Digest of the resolved configuration.
    pub config_digest: Digest,
    /// Name of the dataset, such as `namespace/name-v0`.
    pub dataset_id: &'a str,
    /// Digest of the dataset.
    pub dataset_digest: Digest,
    /// Digest of the preference log, if the run asked for preferences.
    pub preferences_digest: Option<Digest>,
    /// Mean true return of the dataset's episodes.
    pub dataset_return_mean: f64,
    /// Largest true return of the dataset's episodes: a return divided by it is a normalised score.
    pub dataset_return_max: f64,
}
