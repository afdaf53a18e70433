//! Golden vectors: inputs with the outputs that the writer computed. Replaying them bit for bit proves a machine.

use ted_core::integer::IntegerScratch;
use ted_core::quantised::{QuantisedPolicy, QuantisedRewardEnsemble};
use ted_core::{MAX_ACTION, Policy, RewardEnsemble, Scratch, ShapeError};

use crate::arrays::Arrays;
use crate::error::{ArtifactError, Place};
use crate::metadata::Outline;

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

    /// Reads the arrays of the cases; `outline` says how many there are and which networks they are for.
    pub(crate) fn read(arrays: &mut Arrays<'a>, outline: &Outline<'_>) -> Option<Self> {
        let cases = usize::from(outline.golden_cases);
        if cases == 0 {
            return arrays.refuse(ArtifactError::NoGolden);
        }
        let terms = &outline.terms;
        let (observation_dim, action_dim) = (terms.observation.len(), terms.action.len());
        let observations = arrays.take_f32(cases * observation_dim, Place::Golden)?;
        let actions = arrays.take_f32(cases * action_dim, Place::Golden)?;
        let rewards = match outline.reward {
            Some(_) => Some(arrays.take_f32(cases, Place::Golden)?),
            None => None,
        };
        let integers = match outline.integers {
            Some(integers) => Some(IntegerGolden {
                actions: arrays.take(cases * action_dim)?,
                rewards: match integers.reward {
                    Some(_) => Some(arrays.take(cases)?),
                    None => None,
                },
            }),
            None => None,
        };
        Some(Self {
            observation_dim,
            action_dim,
            observations,
            actions,
            rewards,
            integers,
        })
    }

    /// Computes every action again and compares the bits.
    pub(crate) fn verify_policy(
        &self,
        policy: &Policy<'_>,
        scratch: &mut Scratch,
    ) -> Result<(), ArtifactError> {
        for (case, golden) in self.cases().enumerate() {
            let mut actions = [0.0; MAX_ACTION];
            let actual = actions.get_mut(..self.action_dim).unwrap_or_default();
            policy.act(golden.obs_raw, scratch, actual).map_err(shape)?;
            let expected = golden.action_unit;
            same_bits(Place::Policy, case, expected, actual, f32::to_bits)?;
        }
        Ok(())
    }

    /// Computes every reward again and compares the bits.
    pub(crate) fn verify_reward(
        &self,
        reward: &RewardEnsemble<'_>,
        scratch: &mut Scratch,
    ) -> Result<(), ArtifactError> {
        for (case, golden) in self.cases().enumerate() {
            let expected = golden.reward_raw.ok_or(ArtifactError::NoGolden)?;
            let actual = reward
                .raw(golden.obs_raw, golden.action_unit, scratch)
                .map_err(shape)?;
            same_bits(Place::Reward, case, &[expected], &[actual], f32::to_bits)?;
        }
        Ok(())
    }

    /// Computes every action again in integers and compares.
    pub(crate) fn verify_integer_policy(
        &self,
        policy: &QuantisedPolicy<'_>,
        scratch: &mut IntegerScratch,
    ) -> Result<(), ArtifactError> {
        let golden = self.integers.ok_or(ArtifactError::NoIntegers)?;
        let expected = golden.actions.chunks_exact(self.action_dim.max(1));
        for (case, (golden, expected)) in self.cases().zip(expected).enumerate() {
            let mut action = [0; MAX_ACTION];
            let actual = policy
                .act_fixed(golden.obs_raw, scratch, &mut action)
                .map_err(shape)?;
            same_bits(Place::IntegerPolicy, case, expected, actual, |fixed| {
                i32::from(fixed) as u32
            })?;
        }
        Ok(())
    }

    /// Computes every reward again in integers and compares.
    pub(crate) fn verify_integer_reward(
        &self,
        reward: &QuantisedRewardEnsemble<'_>,
        scratch: &mut IntegerScratch,
    ) -> Result<(), ArtifactError> {
        let golden = self.integers.ok_or(ArtifactError::NoIntegers)?;
        let expected = golden.rewards.unwrap_or_default();
        for (case, (golden, expected)) in self.cases().zip(expected).enumerate() {
            let actual = reward
                .sum(golden.obs_raw, golden.action_unit, scratch)
                .map_err(shape)?;
            same_bits(Place::IntegerReward, case, &[*expected], &[actual], |sum| {
                sum as u32
            })?;
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
