//! A reward ensemble in integers that reads raw observations and actions.

use super::quantiser::quantise;
use crate::error::{Part, ShapeError};
use crate::integer::{IntegerRewardEnsemble, IntegerScratch};
use crate::limits::{MAX_ACTION, MAX_OBSERVATION};
use crate::normaliser::Normaliser;
use crate::reward::RewardInput;

/// Reward models in integers behind one input normaliser.
#[derive(Clone, Debug)]
pub struct QuantisedRewardEnsemble<'a> {
    input: RewardInput,
    normaliser: Normaliser<'a>,
    ensemble: IntegerRewardEnsemble<'a>,
}

impl<'a> QuantisedRewardEnsemble<'a> {
    /// Joins a normaliser and an ensemble. The normaliser has one channel per network input.
    ///
    /// # Errors
    /// When they do not have the same number of channels.
    pub fn new(
        input: RewardInput,
        normaliser: Normaliser<'a>,
        ensemble: IntegerRewardEnsemble<'a>,
    ) -> Result<Self, ShapeError> {
        ShapeError::same(Part::Shift, ensemble.inputs(), normaliser.channels())?;
        Ok(Self {
            input,
            normaliser,
            ensemble,
        })
    }

    /// An ensemble without members, a place for [`Self::fill`]: before that it is not to be asked.
    #[must_use]
    pub const fn unfilled() -> Self {
        Self {
            input: RewardInput::Observation,
            normaliser: Normaliser::NONE,
            ensemble: IntegerRewardEnsemble::unfilled(),
        }
    }

    /// Becomes the ensemble of these parts, where it is: `fill` makes the ensemble in integers from one without members.
    ///
    /// # Errors
    /// As [`Self::new`] and `fill`; it is not to be used then.
    pub fn fill<E: From<ShapeError>>(
        &mut self,
        input: RewardInput,
        normaliser: Normaliser<'a>,
        fill: impl FnOnce(&mut IntegerRewardEnsemble<'a>) -> Result<(), E>,
    ) -> Result<(), E> {
        (self.input, self.normaliser) = (input, normaliser);
        fill(&mut self.ensemble)?;
        ShapeError::same(Part::Shift, self.ensemble.inputs(), normaliser.channels())?;
        Ok(())
    }

    /// What computes, in integers.
    #[must_use]
    pub fn integer(&self) -> &IntegerRewardEnsemble<'a> {
        &self.ensemble
    }

    /// The members' outputs for an observation and the action taken on it, added: the reward before its range is cut.
    ///
    /// # Errors
    /// As [`Self::reward_hat`].
    pub fn sum(
        &self,
        obs_raw: &[f32],
        action_unit: &[f32],
        scratch: &mut IntegerScratch,
    ) -> Result<i32, ShapeError> {
        let action_unit = match self.input {
            RewardInput::Observation => &[],
            RewardInput::ObservationAction => action_unit,
        };
        let inputs = self.normaliser.channels();
        let input = scratch
            .input
            .get_mut(..inputs)
            .ok_or(ShapeError::TooLarge {
                part: Part::Input,
                limit: MAX_OBSERVATION + MAX_ACTION,
                actual: inputs,
            })?;
        let fraction_bits = self.ensemble.input_fraction_bits();
        quantise(
            [obs_raw, action_unit],
            &self.normaliser,
            fraction_bits,
            input,
        )?;
        self.ensemble.sum(input, &mut scratch.ping_pong)
    }

    /// Predicts the reward, from 0 to [`crate::integer::IntegerRange::span`].
    ///
    /// # Errors
    /// When `obs_raw` and `action_unit` are together not as many values as the members see. The action is ignored when they
    /// do not see it.
    pub fn reward_hat(
        &self,
        obs_raw: &[f32],
        action_unit: &[f32],
        scratch: &mut IntegerScratch,
    ) -> Result<i32, ShapeError> {
        let sum = self.sum(obs_raw, action_unit, scratch)?;
        Ok(self.ensemble.range().reward_hat(sum))
    }

    /// A reward or a return in the unit of the trained ensemble, for people: rankings use the whole numbers.
    #[must_use]
    pub fn unit(&self, integer: i64) -> f32 {
        match self.ensemble.range().span() {
            0 => 0.0,
            // In single precision, which a microcontroller has.
            span => integer as f32 / span as f32,
        }
    }
}
