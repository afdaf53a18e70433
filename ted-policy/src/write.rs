//! Writes an artefact, and refuses to write one that a reader would refuse.

use std::vec::Vec;

use bytemuck::NoUninit;
use ted_core::integer::{IntegerMlp, IntegerPolicy, IntegerRewardEnsemble, IntegerScratch};
use ted_core::{
    Mlp, Normaliser, Policy, ReturnThreshold, RewardEnsemble, Scratch, ShapeError, TedDiscount,
};

use crate::artifact::Artifact;
use crate::contract::Contract;
use crate::envelope::{self, ALIGNMENT, FORMAT_VERSION, HEADER_LENGTH, MAGIC};
use crate::error::ArtifactError;
use crate::golden_outputs::GoldenOutputs;
use crate::load::ArtifactBytes;
use crate::provenance::Provenance;
use crate::wire::{
    FixedPoint, IntegerReward, IntegerTed, Integers, Metadata, Network, Reward, Ted,
};

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
    /// The same networks in integers, if they are exported too.
    pub integers: Option<IntegerSpec<'a>>,
    /// Raw observations for the golden vectors, one after the other; at least one.
    pub golden_obs_raw: &'a [f32],
}

/// The networks once more, in integers, in the shapes of the float ones and behind their normalisers.
#[derive(Clone, Debug)]
pub struct IntegerSpec<'a> {
    /// The policy.
    pub policy: IntegerPolicy<'a>,
    /// The reward ensemble, exactly if there is one in floats.
    pub reward: Option<IntegerRewardEnsemble<'a>>,
    /// TED's border in the unit of the integer rewards, exactly if there are an ensemble and a discount.
    pub threshold: Option<ReturnThreshold<i64>>,
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
    /// The integer networks have not the shapes of the float ones.
    #[error("export integer networks: their shapes are not those of the trained ones")]
    IntegerShape,
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
    check_integer_shapes(spec)?;
    let golden = GoldenOutputs::compute(spec)?;
    let metadata = postcard::to_stdvec(&metadata(spec, golden.cases))?;
    let blob = blob(spec, &golden);
    let bytes = ArtifactBytes::from_vec(seal(&metadata, &blob)?);
    let artifact = Artifact::parse(&bytes)?;
    artifact.verify_golden(&mut Scratch::new())?;
    if spec.integers.is_some() {
        artifact.verify_integer_golden(&mut IntegerScratch::new())?;
    }
    Ok(bytes.to_vec())
}

/// The format says shapes once, so a reader could not tell that they differ.
fn check_integer_shapes(spec: &ArtifactSpec<'_>) -> Result<(), WriteError> {
    let Some(integers) = &spec.integers else {
        return Ok(());
    };
    let rewards = (&spec.reward, &integers.reward);
    let same = same_shape(spec.policy.mlp(), integers.policy.mlp())
        && match rewards {
            (Some(reward), Some(integer)) => {
                reward.members().len() == integer.members().len()
                    && (reward.members().iter().zip(integer.members()))
                        .all(|(member, integer)| same_shape(member, integer))
            }
            // One without the other is refused by the reader's own check.
            _ => true,
        };
    if same {
        Ok(())
    } else {
        Err(WriteError::IntegerShape)
    }
}

fn same_shape(mlp: &Mlp<'_>, integer: &IntegerMlp<'_>) -> bool {
    mlp.output() == integer.output()
        && mlp.inputs() == integer.inputs()
        && mlp
            .layers()
            .map(|layer| layer.outputs())
            .eq(integer.layers().iter().map(|layer| layer.outputs()))
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
        integers: spec.integers.as_ref().map(|integers| Integers {
            policy: FixedPoint {
                input_fraction_bits: integers.policy.input_fraction_bits(),
                output_fraction_bits: integers.policy.output_fraction_bits(),
            },
            reward: integers.reward.as_ref().map(|reward| IntegerReward {
                fixed_point: FixedPoint {
                    input_fraction_bits: reward.input_fraction_bits(),
                    output_fraction_bits: reward.output_fraction_bits(),
                },
                low: reward.range().low,
                high: reward.range().high,
            }),
            ted: integers.threshold.map(|threshold| IntegerTed {
                return_hat: threshold.return_hat,
                last_tied_episode: threshold.last_tied_episode,
            }),
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
    if let Some(integers) = &spec.integers {
        blob.integer_mlp(integers.policy.mlp());
        let members = integers.reward.iter().flat_map(|reward| reward.members());
        members.for_each(|member| blob.integer_mlp(member));
    }
    blob.array(spec.golden_obs_raw);
    blob.array(&golden.actions);
    if spec.reward.is_some() {
        blob.array(&golden.rewards);
    }
    if let Some(integers) = &spec.integers {
        blob.array(&golden.integer_actions);
        if integers.reward.is_some() {
            blob.array(&golden.integer_rewards);
        }
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

    fn integer_mlp(&mut self, mlp: &IntegerMlp<'_>) {
        for layer in mlp.layers() {
            self.array(layer.weights());
            self.array(layer.bias());
            self.array(layer.multipliers());
            self.array(layer.shifts());
        }
    }
}
