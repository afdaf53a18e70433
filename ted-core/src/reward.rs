//! The learned reward: an ensemble of networks, averaged and mapped to [0, 1].

use heapless::Vec;

use crate::error::{Part, ShapeError};
use crate::limits::{MAX_ACTION, MAX_MEMBERS, MAX_OBSERVATION};
use crate::mlp::Mlp;
use crate::normaliser::Normaliser;
use crate::scratch::Scratch;

/// What a reward model sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RewardInput {
    /// The observation.
    Observation,
    /// The observation followed by the action.
    ObservationAction,
}

/// Smallest and largest raw prediction over the dataset; they become 0 and 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RewardRange {
    /// The raw reward that becomes 0.
    pub low: f32,
    /// The raw reward that becomes 1.
    pub high: f32,
}

impl RewardRange {
    /// Maps a raw reward to [0, 1], clamped; 0 for everything when the range is empty.
    #[must_use]
    pub fn reward_hat(&self, raw: f32) -> f32 {
        if self.high == self.low {
            0.0
        } else {
            ((raw - self.low) / (self.high - self.low)).clamp(0.0, 1.0)
        }
    }
}

/// Reward models that share one input normaliser.
#[derive(Clone, Debug)]
pub struct RewardEnsemble<'a> {
    input: RewardInput,
    normaliser: Normaliser<'a>,
    members: Vec<Mlp<'a>, MAX_MEMBERS>,
    range: RewardRange,
}

impl<'a> RewardEnsemble<'a> {
    /// Joins the members. The normaliser has one channel per network input (action channels included, if seen).
    ///
    /// # Errors
    /// When there is no member, more than [`MAX_MEMBERS`], a member that has not one output, or inputs that differ.
    pub fn new(
        input: RewardInput,
        normaliser: Normaliser<'a>,
        members: &[Mlp<'a>],
        range: RewardRange,
    ) -> Result<Self, ShapeError> {
        let mut ensemble = Self::unfilled();
        ensemble.fill(input, normaliser, members.iter().cloned(), range)?;
        Ok(ensemble)
    }

    /// An ensemble without members, a place for [`Self::fill`]: before that it predicts nothing.
    #[must_use]
    pub const fn unfilled() -> Self {
        Self {
            input: RewardInput::Observation,
            normaliser: Normaliser::NONE,
            members: Vec::new(),
            range: RewardRange {
                low: 0.0,
                high: 0.0,
            },
        }
    }

    /// Becomes the ensemble of these parts, where it is: on a device there is no room to make it elsewhere and move it.
    ///
    /// # Errors
    /// As [`Self::new`]; it is not to be used then.
    pub fn fill(
        &mut self,
        input: RewardInput,
        normaliser: Normaliser<'a>,
        members: impl Iterator<Item = Mlp<'a>>,
        range: RewardRange,
    ) -> Result<(), ShapeError> {
        let limit = match input {
            RewardInput::Observation => MAX_OBSERVATION,
            RewardInput::ObservationAction => MAX_OBSERVATION + MAX_ACTION,
        };
        ShapeError::within(Part::Inputs, limit, normaliser.channels())?;
        (self.input, self.normaliser, self.range) = (input, normaliser, range);
        self.members.clear();
        for member in members {
            ShapeError::same(Part::Inputs, normaliser.channels(), member.inputs())?;
            ShapeError::same(Part::Outputs, 1, member.outputs())?;
            let pushed = self.members.push(member);
            pushed.map_err(|_| too_many(MAX_MEMBERS + 1))?;
        }
        ShapeError::within(Part::Members, MAX_MEMBERS, self.members.len())
    }

    /// What the members see.
    #[must_use]
    pub fn input(&self) -> RewardInput {
        self.input
    }

    /// Number of network inputs.
    #[must_use]
    pub fn inputs(&self) -> usize {
        self.normaliser.channels()
    }

    /// The input normaliser.
    #[must_use]
    pub fn normaliser(&self) -> &Normaliser<'a> {
        &self.normaliser
    }

    /// The members, in order.
    #[must_use]
    pub fn members(&self) -> &[Mlp<'a>] {
        &self.members
    }

    /// The range that is mapped to [0, 1].
    #[must_use]
    pub fn range(&self) -> RewardRange {
        self.range
    }

    /// Predicts with every member, in order.
    ///
    /// # Errors
    /// When `obs_raw` and `action_unit` are together not as many values as the members see. The action is ignored when they
    /// do not see it.
    pub fn member_outputs(
        &self,
        obs_raw: &[f32],
        action_unit: &[f32],
        scratch: &mut Scratch,
    ) -> Result<Vec<f32, MAX_MEMBERS>, ShapeError> {
        let action_unit = match self.input {
            RewardInput::Observation => &[],
            RewardInput::ObservationAction => action_unit,
        };
        let input = scratch.take_input(&[obs_raw, action_unit])?;
        self.normaliser.apply(input.values)?;
        let mut outputs = Vec::new();
        for member in &self.members {
            let mut output = [0.0];
            member.run(input.values, input.ping_pong, &mut output)?;
            let [output] = output;
            outputs
                .push(output)
                .map_err(|_| too_many(self.members.len()))?;
        }
        Ok(outputs)
    }

    /// Predicts the raw reward: the members' sum in order, divided by their number.
    ///
    /// # Errors
    /// As [`Self::member_outputs`].
    pub fn raw(
        &self,
        obs_raw: &[f32],
        action_unit: &[f32],
        scratch: &mut Scratch,
    ) -> Result<f32, ShapeError> {
        Ok(mean(&self.member_outputs(obs_raw, action_unit, scratch)?))
    }

    /// Predicts the reward in [0, 1].
    ///
    /// # Errors
    /// As [`Self::member_outputs`].
    pub fn reward_hat(
        &self,
        obs_raw: &[f32],
        action_unit: &[f32],
        scratch: &mut Scratch,
    ) -> Result<f32, ShapeError> {
        Ok(self
            .range
            .reward_hat(self.raw(obs_raw, action_unit, scratch)?))
    }
}

fn mean(outputs: &[f32]) -> f32 {
    let mut sum = 0.0;
    for output in outputs {
        sum += output;
    }
    sum / outputs.len() as f32
}

fn too_many(actual: usize) -> ShapeError {
    ShapeError::TooLarge {
        part: Part::Members,
        limit: MAX_MEMBERS,
        actual,
    }
}
