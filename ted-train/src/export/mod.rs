//! From a trained run to the artefact that a controller flies, and from the artefact to files for other programs.

mod c_header;
mod facts;
mod floats;
mod onnx;
mod portable;
mod safetensors;

pub use portable::Portable;

use firmware_sim::disk::WriteError as WriteFileError;
use ted_core::integer::IntegerError;
use ted_core::{DiscountClass, Normaliser, Policy, RewardRange, ShapeError, TedDiscount};
use ted_policy::{ArtifactSpec, Digest, Provenance, WriteError};

use crate::contract::contract;
use crate::dataset::Dataset;
use crate::nn::ExportedMlp;
use crate::quantise::{Originals, QuantisationReport, QuantisedNetworks};
use crate::reward::ExportedEnsemble;
use crate::run::{QUANTISATION, RunFolder};
use crate::ted::DiscountConfig;

/// Golden vectors in an artefact: every loader replays them before it flies.
const GOLDEN: usize = 16;

/// Everything of a run that its artefact is made from.
pub struct Export<'a> {
    /// The dataset it was trained on.
    pub dataset: &'a Dataset,
    /// Mean of each observation channel.
    pub shift: &'a [f32],
    /// Inverse deviation of each observation channel.
    pub scale: &'a [f32],
    /// The actor.
    pub actor: &'a ExportedMlp,
    /// The reward ensemble and its range, if the run learned one.
    pub reward: Option<(&'a ExportedEnsemble, RewardRange)>,
    /// TED's lookup and the rule that it follows, if the run used it.
    pub ted: Option<(TedDiscount, &'a DiscountConfig)>,
    /// Predicted return of each episode of the dataset.
    pub returns_hat: &'a [f32],
    /// Name of the composition.
    pub preset: &'a str,
    /// Root seed.
    pub seed: u64,
    /// Updates of the policy.
    pub steps: u64,
    /// Digest of the resolved configuration.
    pub config_digest: Digest,
    /// Digest of the preference log.
    pub preferences_digest: Option<Digest>,
}

/// Why no artefact was written.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The networks are larger than the controller's limits.
    #[error("the controller cannot run this policy: {0}")]
    Shape(#[from] ShapeError),
    /// The observation or action channels cannot be promised.
    #[error("the dataset makes no valid contract: {0}")]
    Contract(#[from] ted_policy::ContractFault),
    /// The networks cannot be brought to integers.
    #[error("quantise the networks: {0}")]
    Quantise(#[from] IntegerError),
    /// The artefact would not be accepted by a reader.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A digest that is not 64 hexadecimal digits.
    #[error("{what} has no valid digest")]
    Digest {
        /// Whose digest.
        what: &'static str,
    },
}

/// An artefact, and what its integers cost.
#[derive(Clone, Debug)]
pub struct Exported {
    /// The bytes of `policy.ted`.
    pub bytes: Vec<u8>,
    /// How its integer networks differ from the float ones.
    pub quantisation: QuantisationReport,
    /// The class of every episode of the dataset by the integers' own returns, if the run used TED on an ensemble's.
    pub integer_classes: Option<Vec<DiscountClass>>,
}

impl Exported {
    /// Puts the artefact into a run's folder, and the report on its integers beside it.
    ///
    /// # Errors
    /// When the disk is full or fails.
    pub fn write(&self, folder: &RunFolder) -> Result<(), WriteFileError> {
        folder.write_artefact(&self.bytes)?;
        folder.write_json(QUANTISATION, &self.quantisation)
    }
}

/// Quantises the networks and makes the bytes of the artefact.
///
/// # Errors
/// When the controller could not run it, or a weight is not finite.
pub fn artefact(export: &Export<'_>) -> Result<Exported, ExportError> {
    let contract = contract(export.dataset)?;
    let policy = Policy::new(
        Normaliser::new(export.shift, export.scale)?,
        export.actor.view()?,
    )?;
    let reward = export
        .reward
        .map(|(ensemble, range)| ensemble.view(range))
        .transpose()?;
    let dataset_digest = export
        .dataset
        .digest()
        .parse()
        .map_err(|_| ExportError::Digest {
            what: "the dataset",
        })?;
    let provenance = Provenance {
        trainer_version: env!("CARGO_PKG_VERSION"),
        preset: export.preset,
        seed: export.seed,
        steps: export.steps,
        config_digest: export.config_digest,
        dataset_id: export.dataset.id(),
        dataset_digest,
        preferences_digest: export.preferences_digest,
        dataset_return_mean: export.dataset.mean_return_true(),
        dataset_return_max: export.dataset.max_return_true(),
    };
    let golden_obs_raw = golden_observations(export.dataset);
    let (integers, quantisation) = QuantisedNetworks::quantise(
        &Originals {
            contract: &contract,
            policy: policy.clone(),
            reward: reward.clone(),
            ted: export.ted,
            returns_hat: export.returns_hat,
        },
        export.dataset,
    )?;
    let spec = ArtifactSpec {
        contract,
        provenance,
        policy,
        reward,
        ted: export.ted.map(|(ted, _)| ted),
        integers: Some(integers.view()?),
        golden_obs_raw: &golden_obs_raw,
    };
    Ok(Exported {
        bytes: ted_policy::write(&spec)?,
        quantisation,
        integer_classes: integers.classes(),
    })
}

/// Observations spread evenly over the dataset.
fn golden_observations(dataset: &Dataset) -> Vec<f32> {
    let steps = dataset.step_count();
    let count = GOLDEN.min(steps);
    (0..count)
        .flat_map(|i| dataset.observation(i * steps / count).iter().copied())
        .collect()
}
