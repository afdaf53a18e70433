//! Golden vectors: inputs with the outputs that the writer computed. Replaying them bit for bit proves a machine.

use ted_core::{MAX_ACTION, Policy, RewardEnsemble, Scratch};

use crate::error::{ArtifactError, Place};

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
            policy
                .act(golden.obs_raw, scratch, actual)
                .map_err(|error| ArtifactError::Shape {
                    place: Place::Golden,
                    error,
                })?;
            same_bits(Place::Policy, case, golden.action_unit, actual)?;
            if let (Some(reward), Some(expected)) = (reward, golden.reward_raw) {
                let actual = reward
                    .raw(golden.obs_raw, golden.action_unit, scratch)
                    .map_err(|error| ArtifactError::Shape {
                        place: Place::Golden,
                        error,
                    })?;
                same_bits(Place::Reward, case, &[expected], &[actual])?;
            }
        }
        Ok(())
    }
}

fn same_bits(
    place: Place,
    case: usize,
    expected: &[f32],
    actual: &[f32],
) -> Result<(), ArtifactError> {
    for (output, (expected, actual)) in expected.iter().zip(actual).enumerate() {
        let (expected, actual) = (expected.to_bits(), actual.to_bits());
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
