//! A policy: standardise the observation, run the network.

use crate::error::{Part, ShapeError};
use crate::limits::{MAX_ACTION, MAX_OBSERVATION};
use crate::mlp::Mlp;
use crate::normaliser::Normaliser;
use crate::scratch::Scratch;

/// A deterministic policy from a raw observation to an action in the policy's own units.
#[derive(Clone, Debug)]
pub struct Policy<'a> {
    normaliser: Normaliser<'a>,
    mlp: Mlp<'a>,
}

impl<'a> Policy<'a> {
    /// Joins a normaliser and a network.
    ///
    /// # Errors
    /// When they do not have the same number of channels, or there are more than [`MAX_OBSERVATION`] observation or
    /// [`MAX_ACTION`] action channels.
    pub fn new(normaliser: Normaliser<'a>, mlp: Mlp<'a>) -> Result<Self, ShapeError> {
        ShapeError::within(Part::Observation, MAX_OBSERVATION, mlp.inputs())?;
        ShapeError::within(Part::Action, MAX_ACTION, mlp.outputs())?;
        ShapeError::same(Part::Shift, mlp.inputs(), normaliser.channels())?;
        Ok(Self { normaliser, mlp })
    }

    /// Number of observation channels.
    #[must_use]
    pub fn observation_dim(&self) -> usize {
        self.mlp.inputs()
    }

    /// Number of action channels.
    #[must_use]
    pub fn action_dim(&self) -> usize {
        self.mlp.outputs()
    }

    /// The observation normaliser.
    #[must_use]
    pub fn normaliser(&self) -> &Normaliser<'a> {
        &self.normaliser
    }

    /// The network.
    #[must_use]
    pub fn mlp(&self) -> &Mlp<'a> {
        &self.mlp
    }

    /// Computes the action for one raw observation.
    ///
    /// # Errors
    /// When `obs_raw` or `action_unit` has another length than the policy.
    pub fn act(
        &self,
        obs_raw: &[f32],
        scratch: &mut Scratch,
        action_unit: &mut [f32],
    ) -> Result<(), ShapeError> {
        ShapeError::same(Part::Observation, self.observation_dim(), obs_raw.len())?;
        ShapeError::same(Part::Action, self.action_dim(), action_unit.len())?;
        let input = scratch.take_input(&[obs_raw])?;
        self.normaliser.apply(input.values)?;
        self.mlp.run(input.values, input.ping_pong, action_unit)
    }
}
