//! From transitions to the scaled inputs of the reward networks.

use serde::{Deserialize, Serialize};

use crate::dataset::{Dataset, ObservationStatistics};

use super::InputScaling;

/// What a reward network sees of a transition.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RewardInputs {
    /// The observation, as OPRL's code does.
    Observation,
    /// The observation and the action, as the paper writes r(s, a).
    #[default]
    ObservationAction,
}

/// The affine map `(raw - shift) * scale` of every input channel: the observation's, then the action's if it is one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct InputMap {
    /// What the channels are.
    pub inputs: RewardInputs,
    /// Subtracted first.
    pub shift: Vec<f32>,
    /// Multiplied then.
    pub scale: Vec<f32>,
}

impl InputMap {
    /// The map of these inputs on the statistics of a dataset. Actions are already in [-1, 1].
    #[must_use]
    pub fn new(
        inputs: RewardInputs,
        scaling: InputScaling,
        statistics: &ObservationStatistics,
        action_dim: usize,
    ) -> Self {
        let observation_dim = statistics.mean.len();
        let [mut shift, mut scale] = scaling.shift_and_scale(statistics);
        if inputs == RewardInputs::ObservationAction {
            shift.resize(observation_dim + action_dim, 0.0);
            scale.resize(observation_dim + action_dim, 1.0);
        }
        Self {
            inputs,
            shift,
            scale,
        }
    }

    /// Number of input channels.
    #[must_use]
    pub fn width(&self) -> usize {
        self.shift.len()
    }

    /// Appends the scaled inputs of one step.
    pub fn push(&self, dataset: &Dataset, step: usize, out: &mut Vec<f32>) {
        let action: &[f32] = match self.inputs {
            RewardInputs::Observation => &[],
            RewardInputs::ObservationAction => dataset.action(step),
        };
        let raw = dataset.observation(step).iter().chain(action);
        out.extend(
            raw.zip(&self.shift)
                .zip(&self.scale)
                .map(|((x, shift), scale)| (x - shift) * scale),
        );
    }
}
