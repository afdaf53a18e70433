//! A policy in integers with floats at both ends.

use super::quantiser::{one, quantise};
use crate::error::{Part, ShapeError};
use crate::integer::{IntegerPolicy, IntegerScratch};
use crate::limits::{MAX_ACTION, MAX_OBSERVATION};
use crate::normaliser::Normaliser;

/// A policy that computes in integers, from a raw observation to an action in the policy's own units.
#[derive(Clone, Debug)]
pub struct QuantisedPolicy<'a> {
    normaliser: Normaliser<'a>,
    policy: IntegerPolicy<'a>,
}

impl<'a> QuantisedPolicy<'a> {
    /// Joins a normaliser and a policy in integers.
    ///
    /// # Errors
    /// When they do not have the same number of channels.
    pub fn new(normaliser: Normaliser<'a>, policy: IntegerPolicy<'a>) -> Result<Self, ShapeError> {
        let inputs = policy.mlp().inputs();
        ShapeError::within(Part::Observation, MAX_OBSERVATION, inputs)?;
        ShapeError::same(Part::Shift, inputs, normaliser.channels())?;
        Ok(Self { normaliser, policy })
    }

    /// Number of observation channels.
    #[must_use]
    pub fn observation_dim(&self) -> usize {
        self.normaliser.channels()
    }

    /// Number of action channels.
    #[must_use]
    pub fn action_dim(&self) -> usize {
        self.policy.mlp().outputs()
    }

    /// The observation normaliser.
    #[must_use]
    pub fn normaliser(&self) -> &Normaliser<'a> {
        &self.normaliser
    }

    /// What computes, in integers.
    #[must_use]
    pub fn integer(&self) -> &IntegerPolicy<'a> {
        &self.policy
    }

    /// Computes the action for one raw observation.
    ///
    /// # Errors
    /// When `obs_raw` or `action_unit` has another length than the policy.
    pub fn act(
        &self,
        obs_raw: &[f32],
        scratch: &mut IntegerScratch,
        action_unit: &mut [f32],
    ) -> Result<(), ShapeError> {
        let mut action = [0; MAX_ACTION];
        let action = self.act_fixed(obs_raw, scratch, &mut action)?;
        ShapeError::same(Part::Action, action.len(), action_unit.len())?;
        // Exact: a power of two, and a numerator of 16 bits.
        let unit = 1.0 / one(self.policy.action_fraction_bits());
        for (action_unit, fixed) in action_unit.iter_mut().zip(action) {
            *action_unit = f32::from(*fixed) * unit;
        }
        Ok(())
    }

    /// Computes the action in fixed point, with [`IntegerPolicy::action_fraction_bits`], into the front of `action`.
    ///
    /// # Errors
    /// When `obs_raw` has another length than the policy.
    pub fn act_fixed<'out>(
        &self,
        obs_raw: &[f32],
        scratch: &mut IntegerScratch,
        action: &'out mut [i16; MAX_ACTION],
    ) -> Result<&'out [i16], ShapeError> {
        ShapeError::same(Part::Observation, self.observation_dim(), obs_raw.len())?;
        let too_many = |part, limit, actual| ShapeError::TooLarge {
            part,
            limit,
            actual,
        };
        let inputs = self.observation_dim();
        let input = scratch.input.get_mut(..inputs).ok_or(too_many(
            Part::Input,
            MAX_OBSERVATION,
            inputs,
        ))?;
        let outputs = self.action_dim();
        let action =
            action
                .get_mut(..outputs)
                .ok_or(too_many(Part::Action, MAX_ACTION, outputs))?;
        let fraction_bits = self.policy.input_fraction_bits();
        quantise([obs_raw, &[]], &self.normaliser, fraction_bits, input)?;
        self.policy.run(input, &mut scratch.ping_pong, action)?;
        Ok(action)
    }
}
