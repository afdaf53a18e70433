//! What a file for other programs is made from: the policy in floats, layer by layer, and the map from its outputs to actions.
//!
//! ```text
//! x      = (observation - shift) * scale
//! x      = relu(weights x + bias)                     for every layer but the last
//! unit   = output(weights x + bias)                   in [-1, 1] where the contract's range is used up
//! action = clamp(middle + half * unit, low, high)     in the robot's own units
//! ```

use ted_core::{Dense, Output, Policy};
use ted_policy::{Artifact, Contract};

use super::facts::Facts;

/// The policy of an artefact, in floats.
pub(super) struct Floats<'a> {
    /// What it expects and promises.
    pub(super) contract: Contract<'a>,
    /// The contract and the origin, as text.
    pub(super) facts: Facts,
    /// What is subtracted from each channel of the observation.
    pub(super) shift: &'a [f32],
    /// What each difference is multiplied with.
    pub(super) scale: &'a [f32],
    /// The layers, first to last: weights row-major `[outputs][inputs]`.
    pub(super) layers: Vec<Dense<'a>>,
    /// What follows the last layer; after the others it is ReLU.
    pub(super) output: Output,
    /// From the network's outputs to actions.
    pub(super) map: Actions,
}

/// From the network's outputs to actions, a value for each channel.
pub(super) struct Actions {
    /// The middle of the channel's range.
    pub(super) middle: Vec<f32>,
    /// Half its width.
    pub(super) half: Vec<f32>,
    /// Its lower end.
    pub(super) low: Vec<f32>,
    /// Its upper end.
    pub(super) high: Vec<f32>,
}

impl<'a> Floats<'a> {
    /// Those of an artefact.
    pub(super) fn of(artifact: &Artifact<'a>) -> Self {
        let contract = artifact.contract();
        let policy: Policy<'a> = artifact.policy();
        Self {
            facts: Facts::of(artifact, &contract),
            shift: policy.normaliser().shift(),
            scale: policy.normaliser().scale(),
            layers: policy.mlp().layers().copied().collect(),
            output: policy.mlp().output(),
            map: Actions::of(&contract),
            contract,
        }
    }

    /// The number of the last layer.
    pub(super) fn last(&self) -> usize {
        self.layers.len().saturating_sub(1)
    }
}

impl Actions {
    fn of(contract: &Contract<'_>) -> Self {
        let channels = || contract.action.iter();
        Self {
            middle: channels().map(|it| it.map().middle()).collect(),
            half: channels().map(|it| it.map().half()).collect(),
            low: channels().map(|it| it.low).collect(),
            high: channels().map(|it| it.high).collect(),
        }
    }
}
