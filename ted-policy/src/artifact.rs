//! A validated artefact: its existence proves that everything in it can be used.

use ted_core::integer::IntegerPolicy;
use ted_core::{Policy, RewardEnsemble, Scratch, TedDiscount};

use crate::arrays::Arrays;
use crate::contract::Contract;
use crate::envelope::Envelope;
use crate::error::{ArtifactError, Place};
use crate::golden::Golden;
use crate::networks;
use crate::provenance::Provenance;
use crate::wire::Metadata;

/// Everything an artefact holds, borrowed from its bytes.
#[derive(Clone, Debug)]
pub struct Artifact<'a> {
    checksum: u32,
    contract: Contract<'a>,
    provenance: Provenance<'a>,
    policy: Policy<'a>,
    reward: Option<RewardEnsemble<'a>>,
    ted: Option<TedDiscount>,
    integer_policy: Option<IntegerPolicy<'a>>,
    golden: Golden<'a>,
}

impl<'a> Artifact<'a> {
    /// Checks everything that can be checked without running a network, and borrows it.
    ///
    /// `bytes` must be the whole file, at an address that is a multiple of four.
    ///
    /// # Errors
    /// On any defect; see [`ArtifactError`]. Run [`Self::verify_golden`] before the policy is trusted.
    pub fn parse(bytes: &'a [u8]) -> Result<Self, ArtifactError> {
        let envelope = Envelope::open(bytes)?;
        let (metadata, rest) = postcard::take_from_bytes::<Metadata<'a>>(envelope.metadata)
            .map_err(|_| ArtifactError::Metadata)?;
        if !rest.is_empty() {
            let actual = envelope.metadata.len();
            return Err(ArtifactError::MetadataLength {
                expected: actual - rest.len(),
                actual,
            });
        }
        Self::join(metadata, &envelope)
    }

    fn join(metadata: Metadata<'a>, envelope: &Envelope<'a>) -> Result<Self, ArtifactError> {
        let Metadata {
            contract,
            provenance,
            policy,
            reward,
            ted,
            integer_policy,
            golden_cases,
        } = metadata;
        contract.check().map_err(ArtifactError::Contract)?;
        if !(provenance.dataset_return_mean.is_finite()
            && provenance.dataset_return_max.is_finite())
        {
            return Err(ArtifactError::NotFinite {
                place: Place::Provenance,
                offset: 0,
            });
        }
        let (observation_dim, action_dim) = (contract.observation.len(), contract.action.len());
        networks::fits(&policy, Place::Policy, observation_dim, action_dim)?;
        if let Some(integer) = &integer_policy {
            networks::fits(
                &integer.network,
                Place::IntegerPolicy,
                observation_dim,
                action_dim,
            )?;
        }
        let mut arrays = Arrays::new(envelope)?;

        let normaliser = networks::normaliser(&mut arrays, observation_dim, Place::Normaliser)?;
        let mlp = networks::mlp(&mut arrays, &policy, Place::Policy)?;
        let policy = Policy::new(normaliser, mlp).map_err(|error| ArtifactError::Shape {
            place: Place::Policy,
            error,
        })?;

        let reward = match &reward {
            Some(reward) => Some(networks::reward(
                &mut arrays,
                reward,
                observation_dim,
                action_dim,
            )?),
            None => None,
        };
        let ted = ted.as_ref().map(networks::ted).transpose()?;
        let integer_policy = match &integer_policy {
            Some(integer) => Some(networks::integer_policy(&mut arrays, integer)?),
            None => None,
        };
        let cases = usize::from(golden_cases);
        if cases == 0 {
            return Err(ArtifactError::NoGolden);
        }
        let golden = Golden {
            observation_dim,
            action_dim,
            observations: arrays.take_f32(cases * observation_dim, Place::Golden)?,
            actions: arrays.take_f32(cases * action_dim, Place::Golden)?,
            rewards: match &reward {
                Some(_) => Some(arrays.take_f32(cases, Place::Golden)?),
                None => None,
            },
        };
        arrays.finish()?;
        Ok(Self {
            checksum: envelope.checksum,
            contract,
            provenance,
            policy,
            reward,
            ted,
            integer_policy,
            golden,
        })
    }

    /// CRC-32 of the file: a short name for these bytes.
    #[must_use]
    pub fn checksum(&self) -> u32 {
        self.checksum
    }

    /// What the policy expects of the world, and what it promises.
    #[must_use]
    pub fn contract(&self) -> &Contract<'a> {
        &self.contract
    }

    /// Where the policy comes from.
    #[must_use]
    pub fn provenance(&self) -> &Provenance<'a> {
        &self.provenance
    }

    /// The policy.
    #[must_use]
    pub fn policy(&self) -> Policy<'a> {
        self.policy.clone()
    }

    /// The reward ensemble, if it was exported too.
    #[must_use]
    pub fn reward(&self) -> Option<RewardEnsemble<'a>> {
        self.reward.clone()
    }

    /// TED's discount, if the run used it.
    #[must_use]
    pub fn ted(&self) -> Option<TedDiscount> {
        self.ted
    }

    /// The policy in integers, if there is one.
    #[must_use]
    pub fn integer_policy(&self) -> Option<IntegerPolicy<'a>> {
        self.integer_policy.clone()
    }

    /// The golden vectors.
    #[must_use]
    pub fn golden(&self) -> Golden<'a> {
        self.golden
    }

    /// Computes every golden vector on this machine and compares the bits.
    ///
    /// # Errors
    /// [`ArtifactError::GoldenMismatch`] at the first bit that differs.
    pub fn verify_golden(&self, scratch: &mut Scratch) -> Result<(), ArtifactError> {
        self.golden
            .verify(&self.policy, self.reward.as_ref(), scratch)
    }
}
