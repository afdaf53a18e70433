//! Golden vectors: inputs with the outputs that the writer computed. Replaying them bit for bit proves a machine.

use ted_core::integer::IntegerScratch;
use ted_core::{MAX_ACTION, Policy, RewardEnsemble, Scratch, ShapeError};

use crate::error::{ArtifactError, Place};
use crate::integers::IntegerNetworks;

/// One input and what must come out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GoldenCase<'a> {
    /// The raw observation.
    pub obs_raw: &'a [f32],
    /// The action that the policy computes from it.
    pub action_unit: &'a [f32],
    /// The raw reward of the two, if the artefact has a reward ensemble.
    pub reward_raw: Option<f32>,
}

/// All golden vectors of an artefact.
#[derive(Clone, Copy, Debug)]
pub struct Golden<'a> {
    pub(crate) observation_dim: usize,
    pub(crate) action_dim: usize,
    pub(crate) observations: &'a [f32],
    pub(crate) actions: &'a [f32],
    pub(crate) rewards: Option<&'a [f32]>,
    pub(crate) integers: Option<IntegerGolden<'a>>,
}

/// What the integer networks compute for the same observations.
#[derive(Clone, Copy, Debug)]
pub(crate) struct IntegerGolden<'a> {
    pub(crate) actions: &'a [i16],
    pub(crate) rewards: Option<&'a [i32]>,
}

impl<'a> Golden<'a> {
    /// The vectors, in order.
    pub fn cases(&self) -> impl Iterator<Item = GoldenCase<'a>> + use<'a> {
        let Self {
            observation_dim,
            action_dim,
            mut observations,
            mut actions,
            rewards,
            ..
        } = *self;
        let mut rewards = rewards.map(<[f32]>::iter);
        core::iter::from_fn(move || {
            let (obs_raw, rest) = observations
                .split_at_checked(observation_dim)
                .filter(|(row, _)| !row.is_empty())?;
            observations = rest;
            let (action_unit, rest) = actions.split_at_checked(action_dim)?;
            actions = rest;
            let reward_raw = rewards.as_mut().and_then(|rewards| rewards.next().copied());
            Some(GoldenCase {
                obs_raw,
                action_unit,
                reward_raw,
            })
        })
    }

    /// Computes every case again and compares the bits.
    pub(crate) fn verify(
        &self,
        policy: &Policy<'_>,
        reward: Option<&RewardEnsemble<'_>>,
        scratch: &mut Scratch,
    ) -> Result<(), ArtifactError> {
        for (case, golden) in self.cases().enumerate() {
            let mut actions = [0.0; MAX_ACTION];
            let actual = actions.get_mut(..self.action_dim).unwrap_or_default();
            policy.act(golden.obs_raw, scratch, actual).map_err(shape)?;
            same_bits(
                Place::Policy,
                case,
                golden.action_unit,
                actual,
                f32::to_bits,
            )?;
            if let (Some(reward), Some(expected)) = (reward, golden.reward_raw) {
                let actual = reward
                    .raw(golden.obs_raw, golden.action_unit, scratch)
                    .map_err(shape)?;
                same_bits(Place::Reward, case, &[expected], &[actual], f32::to_bits)?;
            }
        }
        Ok(())
    }

    /// Computes every case again in integers and compares.
    pub(crate) fn verify_integers(
        &self,
        networks: &IntegerNetworks<'_>,
        scratch: &mut IntegerScratch,
    ) -> Result<(), ArtifactError> {
        let golden = self.integers.ok_or(ArtifactError::NoIntegers)?;
        let mut expected_actions = golden.actions.chunks_exact(self.action_dim.max(1));
        let mut expected_rewards = golden.rewards.unwrap_or_default().iter();
        for (
            case,
            GoldenCase {
                obs_raw,
                action_unit,
                ..
            },
        ) in self.cases().enumerate()
        {
            let mut action = [0; MAX_ACTION];
            let actual = networks
                .policy
                .act_fixed(obs_raw, scratch, &mut action)
                .map_err(shape)?;
            let expected = expected_actions.next().unwrap_or_default();
            same_bits(Place::IntegerPolicy, case, expected, actual, |fixed| {
                i32::from(fixed) as u32
            })?;
            if let (Some(reward), Some(expected)) = (&networks.reward, expected_rewards.next()) {
                let actual = reward.sum(obs_raw, action_unit, scratch).map_err(shape)?;
                same_bits(Place::IntegerReward, case, &[*expected], &[actual], |sum| {
                    sum as u32
                })?;
            }
        }
        Ok(())
    }
}

fn shape(error: ShapeError) -> ArtifactError {
    ArtifactError::Shape {
        place: Place::Golden,
        error,
    }
}

/// Passes when every number has the same bits.
fn same_bits<T: Copy>(
    place: Place,
    case: usize,
    expected: &[T],
    actual: &[T],
    bits: impl Fn(T) -> u32,
) -> Result<(), ArtifactError> {
    for (output, (expected, actual)) in expected.iter().zip(actual).enumerate() {
        let (expected, actual) = (bits(*expected), bits(*actual));
        if expected != actual {
            return Err(ArtifactError::GoldenMismatch {
                place,
                case,
                output,
                expected,
                actual,
            });
        }
    }
    Ok(())
}
