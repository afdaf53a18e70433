//! A validated artefact: its existence proves that everything in it can be used.

use ted_core::integer::IntegerScratch;
use ted_core::{Policy, RewardEnsemble, Scratch, TedDiscount};

use crate::arrays::Arrays;
use crate::contract::Contract;
use crate::envelope::Envelope;
use crate::error::{ArtifactError, Place};
use crate::golden::{Golden, IntegerGolden};
use crate::integers::{self, IntegerNetworks, Originals};
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
    integers: Option<IntegerNetworks<'a>>,
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
            integers,
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
        networks::fits(&policy, observation_dim, action_dim)?;
        let (network, ensemble) = (policy, reward);
        let mut arrays = Arrays::new(envelope)?;

        let normaliser = networks::normaliser(&mut arrays, observation_dim, Place::Normaliser)?;
        let mlp = networks::mlp(&mut arrays, &network, Place::Policy)?;
        let policy = Policy::new(normaliser, mlp).map_err(|error| ArtifactError::Shape {
            place: Place::Policy,
            error,
        })?;

        let reward = match &ensemble {
            Some(reward) => Some(networks::reward(
                &mut arrays,
                reward,
                observation_dim,
                action_dim,
            )?),
            None => None,
        };
        let ted = ted.as_ref().map(networks::ted).transpose()?;
        let integers = match &integers {
            Some(integers) => Some(integers::read(
                &mut arrays,
                integers,
                &network,
                ensemble.as_ref(),
                Originals {
                    policy: &policy,
                    reward: reward.as_ref(),
                    ted: ted.as_ref(),
                },
            )?),
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
            integers: match &integers {
                Some(integers) => Some(IntegerGolden {
                    actions: arrays.take(cases * action_dim)?,
                    rewards: match &integers.reward {
                        Some(_) => Some(arrays.take(cases)?),
                        None => None,
                    },
                }),
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
            integers,
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

    /// The networks in integers, if they were exported too.
    #[must_use]
    pub fn integers(&self) -> Option<&IntegerNetworks<'a>> {
        self.integers.as_ref()
    }

    /// The golden vectors.
    #[must_use]
    pub fn golden(&self) -> Golden<'a> {
        self.golden
    }

    /// Computes every golden vector in floats on this machine and compares the bits.
    ///
    /// # Errors
    /// [`ArtifactError::GoldenMismatch`] at the first bit that differs.
    pub fn verify_golden(&self, scratch: &mut Scratch) -> Result<(), ArtifactError> {
        self.golden
            .verify(&self.policy, self.reward.as_ref(), scratch)
    }

    /// Computes every golden vector in integers on this machine and compares.
    ///
    /// # Errors
    /// [`ArtifactError::GoldenMismatch`] at the first number that differs, [`ArtifactError::NoIntegers`] if there are none.
    pub fn verify_integer_golden(&self, scratch: &mut IntegerScratch) -> Result<(), ArtifactError> {
        let integers = self.integers().ok_or(ArtifactError::NoIntegers)?;
        self.golden.verify_integers(integers, scratch)
    }
}
