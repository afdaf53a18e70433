//! A validated artefact: its existence proves that everything in it can be used.

use ted_core::integer::IntegerScratch;
use ted_core::quantised::{QuantisedPolicy, QuantisedRewardEnsemble};
use ted_core::{Normaliser, Policy, ReturnThreshold, RewardEnsemble, Scratch, TedDiscount};

use crate::arrays::{Arrays, Blob};
use crate::contract::Contract;
use crate::decode::decode;
use crate::envelope::Envelope;
use crate::error::{ArtifactError, Place};
use crate::golden::Golden;
use crate::integers::{self, IntegerNetworks};
use crate::metadata::{Outline, RewardShape, Terms};
use crate::networks;
use crate::provenance::Provenance;
use crate::wire::Integers;

/// Everything an artefact holds, borrowed from its bytes.
///
/// It is small: the policy is ready, and everything else is put together when it is asked for.
#[derive(Clone, Debug)]
pub struct Artifact<'a> {
    checksum: u32,
    outline: Outline<'a>,
    blob: Blob<'a>,
    parts: Parts<'a>,
}

/// What was read of the blob.
#[derive(Clone, Debug)]
struct Parts<'a> {
    policy: Policy<'a>,
    ted: Option<TedDiscount>,
    /// Where the arrays of the reward ensemble start, and those of the integer networks.
    reward_position: usize,
    integer_position: usize,
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
        let outline = Outline::read(envelope.metadata)?;
        let terms = &outline.terms;
        terms.check().map_err(ArtifactError::Contract)?;
        if !outline.finite_provenance {
            return Err(ArtifactError::NotFinite {
                place: Place::Provenance,
                offset: 0,
            });
        }
        let (observation_dim, action_dim) = (terms.observation.len(), terms.action.len());
        networks::fits(&outline.policy, observation_dim, action_dim)?;
        let blob = Blob::of(&envelope)?;
        let mut arrays = blob.arrays(0);
        let Some(parts) = Parts::read(&mut arrays, &outline, blob) else {
            return Err(arrays.defect());
        };
        Ok(Self {
            checksum: envelope.checksum,
            outline,
            blob,
            parts,
        })
    }

    /// CRC-32 of the file: a short name for these bytes.
    #[must_use]
    pub fn checksum(&self) -> u32 {
        self.checksum
    }

    /// What the policy expects of the world, and what it promises.
    #[must_use]
    pub fn contract(&self) -> Contract<'a> {
        Contract::of(&self.outline.terms)
    }

    /// The same, with its channels where they lie: for a controller, which has little memory.
    #[must_use]
    pub fn terms(&self) -> &Terms<'a> {
        &self.outline.terms
    }

    /// Where the policy comes from.
    #[must_use]
    pub fn provenance(&self) -> Provenance<'a> {
        // It was decoded once, so it can be again.
        let mut bytes = self.outline.provenance;
        decode(&mut bytes).unwrap_or_default()
    }

    /// The policy.
    #[must_use]
    pub fn policy(&self) -> Policy<'a> {
        self.parts.policy.clone()
    }

    /// The reward ensemble, if it was exported too.
    #[must_use]
    pub fn reward(&self) -> Option<RewardEnsemble<'a>> {
        let mut reward = RewardEnsemble::unfilled();
        self.read_reward(&mut reward).then_some(reward)
    }

    /// Makes `into` the reward ensemble; false if it was not exported.
    pub fn read_reward(&self, into: &mut RewardEnsemble<'a>) -> bool {
        let Some(shape) = &self.outline.reward else {
            return false;
        };
        // It was put together once, so it can be again.
        let mut arrays = self.blob.arrays(self.parts.reward_position);
        networks::reward(&mut arrays, shape, &self.outline.terms, into).is_some()
    }

    /// TED's discount, if the run used it.
    #[must_use]
    pub fn ted(&self) -> Option<TedDiscount> {
        self.parts.ted
    }

    /// Whether the networks were exported in integers too.
    #[must_use]
    pub fn has_integers(&self) -> bool {
        self.outline.integers.is_some()
    }

    /// The networks in integers, if they were exported too.
    #[must_use]
    pub fn integers(&self) -> Option<IntegerNetworks<'a>> {
        Some(IntegerNetworks {
            policy: self.integer_policy()?,
            reward: self.integer_reward(),
            threshold: self.integer_threshold(),
        })
    }

    /// The policy in integers, if it was exported too.
    #[must_use]
    pub fn integer_policy(&self) -> Option<QuantisedPolicy<'a>> {
        self.integer_policy_and_rest().map(|(policy, _)| policy)
    }

    /// The reward ensemble in integers, if it was exported too.
    #[must_use]
    pub fn integer_reward(&self) -> Option<QuantisedRewardEnsemble<'a>> {
        let mut reward = QuantisedRewardEnsemble::unfilled();
        self.read_integer_reward(&mut reward).then_some(reward)
    }

    /// Makes `into` the reward ensemble in integers; false if it was not exported.
    pub fn read_integer_reward(&self, into: &mut QuantisedRewardEnsemble<'a>) -> bool {
        let parts = self
            .outline
            .integers
            .as_ref()
            .zip(self.outline.reward.as_ref());
        let Some((
            Integers {
                reward: Some(integer),
                ..
            },
            shape,
        )) = parts
        else {
            return false;
        };
        let Some((_, mut arrays)) = self.integer_policy_and_rest() else {
            return false;
        };
        let reward_arrays = self.blob.arrays(self.parts.reward_position);
        reward_normaliser(reward_arrays, shape, &self.outline.terms)
            .and_then(|normaliser| integers::reward(&mut arrays, *integer, shape, normaliser, into))
            .is_some()
    }

    /// TED's border in the unit of the integer rewards, if the run used TED and the networks were exported in integers.
    #[must_use]
    pub fn integer_threshold(&self) -> Option<ReturnThreshold<i64>> {
        let ted = self.outline.integers?.ted?;
        Some(ReturnThreshold {
            return_hat: ted.return_hat,
            last_tied_episode: ted.last_tied_episode,
        })
    }

    fn integer_policy_and_rest(&self) -> Option<(QuantisedPolicy<'a>, Arrays<'a>)> {
        let integers = self.outline.integers?;
        let mut arrays = self.blob.arrays(self.parts.integer_position);
        let normaliser = *self.parts.policy.normaliser();
        let network = &self.outline.policy;
        let policy = integers::policy(&mut arrays, integers.policy, network, normaliser)?;
        Some((policy, arrays))
    }

    /// The golden vectors.
    #[must_use]
    pub fn golden(&self) -> Golden<'a> {
        self.parts.golden
    }

    /// Computes every golden vector in floats on this machine and compares the bits.
    ///
    /// # Errors
    /// [`ArtifactError::GoldenMismatch`] at the first bit that differs.
    pub fn verify_golden(&self, scratch: &mut Scratch) -> Result<(), ArtifactError> {
        self.parts
            .golden
            .verify_policy(&self.parts.policy, scratch)?;
        let mut reward = RewardEnsemble::unfilled();
        match self.read_reward(&mut reward) {
            true => self.parts.golden.verify_reward(&reward, scratch),
            false => Ok(()),
        }
    }

    /// Computes every golden vector in integers on this machine and compares.
    ///
    /// # Errors
    /// [`ArtifactError::GoldenMismatch`] at the first number that differs, [`ArtifactError::NoIntegers`] if there are none.
    pub fn verify_integer_golden(&self, scratch: &mut IntegerScratch) -> Result<(), ArtifactError> {
        let policy = self.integer_policy().ok_or(ArtifactError::NoIntegers)?;
        self.parts.golden.verify_integer_policy(&policy, scratch)?;
        let mut reward = QuantisedRewardEnsemble::unfilled();
        match self.read_integer_reward(&mut reward) {
            true => self.parts.golden.verify_integer_reward(&reward, scratch),
            false => Ok(()),
        }
    }
}

impl<'a> Parts<'a> {
    /// Reads all arrays once.
    fn read(arrays: &mut Arrays<'a>, outline: &Outline<'a>, blob: Blob<'a>) -> Option<Self> {
        let terms = &outline.terms;
        let normaliser = networks::normaliser(arrays, terms.observation.len(), Place::Normaliser)?;
        let mlp = networks::mlp(arrays, &outline.policy, Place::Policy)?;
        let policy = arrays.shaped(Place::Policy, Policy::new(normaliser, mlp))?;
        let reward_position = arrays.position();
        if let Some(reward) = &outline.reward {
            check_reward(arrays, reward, terms)?;
        }
        let ted = match outline.ted.as_ref().map(networks::ted).transpose() {
            Ok(ted) => ted,
            Err(error) => return arrays.refuse(error),
        };
        let integer_position = arrays.position();
        if let Some(integers) = outline.integers {
            integers::policy(arrays, integers.policy, &outline.policy, normaliser)?;
            let reward_arrays = blob.arrays(reward_position);
            check_integer_reward(arrays, reward_arrays, integers, outline)?;
            // A border is one of predicted returns: without an ensemble nobody here could compute them.
            if integers.ted.is_some() != (outline.reward.is_some() && ted.is_some()) {
                return arrays.refuse(ArtifactError::IntegerPart {
                    place: Place::Discount,
                });
            }
        }
        let golden = Golden::read(arrays, outline)?;
        arrays.finish()?;
        Some(Self {
            policy,
            ted,
            reward_position,
            integer_position,
            golden,
        })
    }
}

/// Puts the reward ensemble together once. Apart, so that its memory is taken for no longer than that.
#[inline(never)]
fn check_reward(arrays: &mut Arrays<'_>, shape: &RewardShape<'_>, terms: &Terms<'_>) -> Option<()> {
    networks::reward(arrays, shape, terms, &mut RewardEnsemble::unfilled())
}

/// The same in integers; `reward_arrays` are those of the floats.
#[inline(never)]
fn check_integer_reward<'a>(
    arrays: &mut Arrays<'a>,
    reward_arrays: Arrays<'a>,
    integers: Integers,
    outline: &Outline<'_>,
) -> Option<()> {
    match (integers.reward, &outline.reward) {
        (Some(integer), Some(shape)) => {
            // It was read once, so it can be again.
            let normaliser = reward_normaliser(reward_arrays, shape, &outline.terms)?;
            let mut reward = QuantisedRewardEnsemble::unfilled();
            integers::reward(arrays, integer, shape, normaliser, &mut reward)
        }
        (None, None) => Some(()),
        _ => arrays.refuse(ArtifactError::IntegerPart {
            place: Place::Reward,
        }),
    }
}

/// The reward ensemble's normaliser, which comes first of its arrays.
fn reward_normaliser<'a>(
    mut reward_arrays: Arrays<'a>,
    shape: &RewardShape<'_>,
    terms: &Terms<'_>,
) -> Option<Normaliser<'a>> {
    let seen = shape.inputs(terms);
    networks::normaliser(&mut reward_arrays, seen, Place::RewardNormaliser)
}
