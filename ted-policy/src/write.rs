//! Writes an artefact, and refuses to write one that a reader would refuse.

use std::vec::Vec;

use bytemuck::NoUninit;
use ted_core::integer::IntegerPolicy;
use ted_core::{
    MAX_ACTION, Mlp, Normaliser, Policy, RewardEnsemble, Scratch, ShapeError, TedDiscount,
};

use crate::artifact::Artifact;
use crate::contract::Contract;
use crate::envelope::{self, ALIGNMENT, FORMAT_VERSION, HEADER_LENGTH, MAGIC};
use crate::error::ArtifactError;
use crate::load::ArtifactBytes;
use crate::provenance::Provenance;
use crate::wire::{Integer, Metadata, Network, Reward, Ted};

/// What goes into an artefact. The golden outputs are computed from it by `ted-core` itself.
#[derive(Clone, Debug)]
pub struct ArtifactSpec<'a> {
    /// What the policy expects of the world, and what it promises.
    pub contract: Contract<'a>,
    /// Where the policy comes from.
    pub provenance: Provenance<'a>,
    /// The policy.
    pub policy: Policy<'a>,
    /// The reward ensemble, if it is exported too.
    pub reward: Option<RewardEnsemble<'a>>,
    /// TED's discount, if the run used it.
    pub ted: Option<TedDiscount>,
    /// The policy in integers, if there is one.
    pub integer_policy: Option<IntegerPolicy<'a>>,
    /// Raw observations for the golden vectors, one after the other; at least one.
    pub golden_obs_raw: &'a [f32],
}

/// Why an artefact was not written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The golden observations are not whole observations, or too many of them.
    #[error("golden observations hold {actual} numbers, need 1 to 65535 rows of {width}")]
    GoldenLength {
        /// Numbers in one observation.
        width: usize,
        /// Numbers there are.
        actual: usize,
    },
    /// A golden vector does not fit the networks.
    #[error("run golden vectors: {0}")]
    Golden(#[from] ShapeError),
    /// The metadata could not be encoded.
    #[error("encode artefact metadata: {0}")]
    Encode(#[from] postcard::Error),
    /// The artefact would be longer than its 32-bit length can say.
    #[error("artefact would have {actual} bytes, at most {limit} fit")]
    TooLong {
        /// The longest artefact.
        limit: usize,
        /// What it would have.
        actual: usize,
    },
    /// A reader would refuse it.
    #[error("export policy: {0}")]
    Refused(#[from] ArtifactError),
}

/// Writes the artefact. The same specification gives the same bytes on every machine.
///
/// # Errors
/// When [`Artifact::parse`] would refuse the result: NaN or infinite numbers, scales that are not positive, shapes that
/// do not match the contract. Nothing is returned then.
pub fn write(spec: &ArtifactSpec<'_>) -> Result<Vec<u8>, WriteError> {
    let golden = GoldenOutputs::compute(spec)?;
    let metadata = postcard::to_stdvec(&metadata(spec, golden.cases))?;
    let blob = blob(spec, &golden);
    let bytes = ArtifactBytes::from_vec(seal(&metadata, &blob)?);
    Artifact::parse(&bytes)?.verify_golden(&mut Scratch::new())?;
    Ok(bytes.to_vec())
}

fn metadata<'a>(spec: &ArtifactSpec<'a>, golden_cases: u16) -> Metadata<'a> {
    Metadata {
        contract: spec.contract.clone(),
        provenance: spec.provenance.clone(),
        policy: Network::of(spec.policy.mlp()),
        reward: spec.reward.as_ref().map(|reward| Reward {
            input: reward.input().into(),
            low: reward.range().low,
            high: reward.range().high,
            members: reward.members().iter().map(Network::of).collect(),
        }),
        ted: spec.ted.map(|ted| Ted {
            gamma: ted.gamma(),
            sigma: ted.sigma(),
            return_hat: ted.threshold().return_hat,
            last_tied_episode: ted.threshold().last_tied_episode,
        }),
        integer_policy: spec.integer_policy.as_ref().map(|integer| Integer {
            input_fraction_bits: integer.input_fraction_bits(),
            output_fraction_bits: integer.output_fraction_bits(),
            network: Network::of_integer(integer.mlp()),
        }),
        golden_cases,
    }
}

fn blob(spec: &ArtifactSpec<'_>, golden: &GoldenOutputs) -> Vec<u8> {
    let mut blob = Blob::default();
    blob.normaliser(spec.policy.normaliser());
    blob.mlp(spec.policy.mlp());
    if let Some(reward) = &spec.reward {
        blob.normaliser(reward.normaliser());
        reward.members().iter().for_each(|member| blob.mlp(member));
    }
    for layer in spec
        .integer_policy
        .iter()
        .flat_map(|integer| integer.mlp().layers())
    {
        blob.array(layer.weights());
        blob.array(layer.bias());
        blob.array(layer.multipliers());
        blob.array(layer.shifts());
    }
    blob.array(spec.golden_obs_raw);
    blob.array(&golden.actions);
    if spec.reward.is_some() {
        blob.array(&golden.rewards);
    }
    blob.bytes
}

/// Puts the header in front of the two sections.
fn seal(metadata: &[u8], blob: &[u8]) -> Result<Vec<u8>, WriteError> {
    let blob_offset = (HEADER_LENGTH + metadata.len()).next_multiple_of(ALIGNMENT);
    let total = blob_offset + blob.len();
    let field = |value: usize| {
        u32::try_from(value).map_err(|_| WriteError::TooLong {
            limit: u32::MAX as usize,
            actual: total,
        })
    };
    let mut bytes = Vec::with_capacity(total);
    bytes.extend(MAGIC);
    let unsealed = 0;
    for value in [
        FORMAT_VERSION,
        unsealed,
        field(total)?,
        field(HEADER_LENGTH)?,
        field(metadata.len())?,
        field(blob_offset)?,
        field(blob.len())?,
    ] {
        bytes.extend(value.to_le_bytes());
    }
    bytes.resize(HEADER_LENGTH, 0);
    bytes.extend(metadata);
    bytes.resize(blob_offset, 0);
    bytes.extend(blob);
    envelope::stamp(&mut bytes);
    Ok(bytes)
}

/// Arrays one after the other, each followed by zeros up to the next multiple of the alignment.
#[derive(Default)]
struct Blob {
    bytes: Vec<u8>,
}

impl Blob {
    fn array<T: NoUninit>(&mut self, values: &[T]) {
        self.bytes.extend(bytemuck::cast_slice::<T, u8>(values));
        self.bytes
            .resize(self.bytes.len().next_multiple_of(ALIGNMENT), 0);
    }

    fn normaliser(&mut self, normaliser: &Normaliser<'_>) {
        self.array(normaliser.shift());
        self.array(normaliser.scale());
    }

    fn mlp(&mut self, mlp: &Mlp<'_>) {
        for layer in mlp.layers() {
            self.array(layer.weights());
            self.array(layer.bias());
        }
    }
}

/// What the networks compute for the golden observations.
struct GoldenOutputs {
    cases: u16,
    actions: Vec<f32>,
    rewards: Vec<f32>,
}

impl GoldenOutputs {
    fn compute(spec: &ArtifactSpec<'_>) -> Result<Self, WriteError> {
        let width = spec.policy.observation_dim();
        let wrong_length = || WriteError::GoldenLength {
            width,
            actual: spec.golden_obs_raw.len(),
        };
        let rows = spec.golden_obs_raw.chunks_exact(width);
        if spec.golden_obs_raw.is_empty() || !rows.remainder().is_empty() {
            return Err(wrong_length());
        }
        let cases = u16::try_from(rows.len()).map_err(|_| wrong_length())?;
        let mut scratch = Scratch::new();
        let mut action = [0.0; MAX_ACTION];
        let action = action
            .get_mut(..spec.policy.action_dim())
            .unwrap_or_default();
        let mut outputs = Self {
            cases,
            actions: Vec::new(),
            rewards: Vec::new(),
        };
        for obs_raw in rows {
            spec.policy.act(obs_raw, &mut scratch, action)?;
            outputs.actions.extend_from_slice(action);
            if let Some(reward) = &spec.reward {
                outputs
                    .rewards
                    .push(reward.raw(obs_raw, action, &mut scratch)?);
            }
        }
        Ok(outputs)
    }
}
