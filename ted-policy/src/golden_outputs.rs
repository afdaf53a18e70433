//! What the networks compute for the golden observations: every reader has to compute the same.

use std::vec::Vec;

use ted_core::integer::IntegerScratch;
use ted_core::quantised::{QuantisedPolicy, QuantisedRewardEnsemble};
use ted_core::{MAX_ACTION, Scratch};

use crate::error::{ArtifactError, Place};
use crate::write::{ArtifactSpec, WriteError};

/// The outputs of every golden vector, one after the other.
pub(crate) struct GoldenOutputs {
    pub(crate) cases: u16,
    pub(crate) actions: Vec<f32>,
    pub(crate) rewards: Vec<f32>,
    pub(crate) integer_actions: Vec<i16>,
    pub(crate) integer_rewards: Vec<i32>,
}

impl GoldenOutputs {
    /// Runs the networks of a specification on its golden observations.
    pub(crate) fn compute(spec: &ArtifactSpec<'_>) -> Result<Self, WriteError> {
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
        let mut outputs = Self {
            cases,
            actions: Vec::new(),
            rewards: Vec::new(),
            integer_actions: Vec::new(),
            integer_rewards: Vec::new(),
        };
        outputs.run_floats(spec)?;
        outputs.run_integers(spec)?;
        Ok(outputs)
    }

    fn run_floats(&mut self, spec: &ArtifactSpec<'_>) -> Result<(), WriteError> {
        let mut scratch = Scratch::new();
        let mut action = [0.0; MAX_ACTION];
        let action = action
            .get_mut(..spec.policy.action_dim())
            .unwrap_or_default();
        for obs_raw in spec
            .golden_obs_raw
            .chunks_exact(spec.policy.observation_dim())
        {
            spec.policy.act(obs_raw, &mut scratch, action)?;
            self.actions.extend_from_slice(action);
            if let Some(reward) = &spec.reward {
                self.rewards
                    .push(reward.raw(obs_raw, action, &mut scratch)?);
            }
        }
        Ok(())
    }

    fn run_integers(&mut self, spec: &ArtifactSpec<'_>) -> Result<(), WriteError> {
        let Some(integers) = &spec.integers else {
            return Ok(());
        };
        let normaliser = *spec.policy.normaliser();
        let policy = QuantisedPolicy::new(normaliser, integers.policy.clone())?;
        let reward = match (&integers.reward, &spec.reward) {
            (Some(integer), Some(reward)) => {
                let (input, normaliser) = (reward.input(), *reward.normaliser());
                let reward = QuantisedRewardEnsemble::new(input, normaliser, integer.clone())?;
                Some(reward)
            }
            (None, None) => None,
            _ => {
                let place = Place::Reward;
                return Err(ArtifactError::IntegerPart { place }.into());
            }
        };
        let mut scratch = IntegerScratch::new();
        let rows = spec
            .golden_obs_raw
            .chunks_exact(spec.policy.observation_dim());
        for (obs_raw, action_unit) in rows.zip(self.actions.chunks_exact(spec.policy.action_dim()))
        {
            let mut action = [0; MAX_ACTION];
            let action = policy.act_fixed(obs_raw, &mut scratch, &mut action)?;
            self.integer_actions.extend_from_slice(action);
            if let Some(reward) = &reward {
                self.integer_rewards
                    .push(reward.sum(obs_raw, action_unit, &mut scratch)?);
            }
        }
        Ok(())
    }
}
