//! The metadata as it is on the wire, format version 2.
//!
//! `docs/artifact-format.md` describes these types and carries their fingerprint. Postcard is not self-describing: any
//! change here, a new order included, is a new format version.

use heapless::Vec;
use serde::{Deserialize, Serialize};
#[cfg(feature = "std")]
use ted_core::MAX_MEMBERS;
#[cfg(feature = "std")]
use ted_core::Mlp;
use ted_core::{MAX_LAYERS, Output, RewardInput};

#[cfg(feature = "std")]
use crate::contract::Contract;
#[cfg(feature = "std")]
use crate::provenance::Provenance;

/// All of it, for writing; it is read by [`crate::metadata`].
#[cfg(feature = "std")]
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Metadata<'a> {
    #[serde(borrow)]
    pub(crate) contract: Contract<'a>,
    #[serde(borrow)]
    pub(crate) provenance: Provenance<'a>,
    pub(crate) policy: Network,
    pub(crate) reward: Option<Reward>,
    pub(crate) ted: Option<Ted>,
    pub(crate) integers: Option<Integers>,
    pub(crate) golden_cases: u16,
}

/// A network: its widths from input to output, so one more than it has layers.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Network {
    pub(crate) output: Activation,
    pub(crate) widths: Vec<u16, { MAX_LAYERS + 1 }>,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) enum Activation {
    Linear,
    Tanh,
}

#[cfg(feature = "std")]
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Reward {
    pub(crate) input: Sees,
    pub(crate) low: f32,
    pub(crate) high: f32,
    pub(crate) members: Vec<Network, MAX_MEMBERS>,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) enum Sees {
    Observation,
    ObservationAction,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Ted {
    pub(crate) gamma: f32,
    pub(crate) sigma: f32,
    pub(crate) return_hat: f32,
    pub(crate) last_tied_episode: u32,
}

/// The networks once more, in integers: the same shapes, so only their numbers differ.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Integers {
    pub(crate) policy: FixedPoint,
    pub(crate) reward: Option<IntegerReward>,
    pub(crate) ted: Option<IntegerTed>,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct FixedPoint {
    pub(crate) input_fraction_bits: u8,
    pub(crate) output_fraction_bits: u8,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct IntegerReward {
    pub(crate) fixed_point: FixedPoint,
    pub(crate) low: i32,
    pub(crate) high: i32,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct IntegerTed {
    pub(crate) return_hat: i64,
    pub(crate) last_tied_episode: u32,
}

impl From<Activation> for Output {
    fn from(activation: Activation) -> Self {
        match activation {
            Activation::Linear => Self::Linear,
            Activation::Tanh => Self::Tanh,
        }
    }
}

impl From<Output> for Activation {
    fn from(output: Output) -> Self {
        match output {
            Output::Linear => Self::Linear,
            Output::Tanh => Self::Tanh,
        }
    }
}

impl From<Sees> for RewardInput {
    fn from(sees: Sees) -> Self {
        match sees {
            Sees::Observation => Self::Observation,
            Sees::ObservationAction => Self::ObservationAction,
        }
    }
}

impl From<RewardInput> for Sees {
    fn from(input: RewardInput) -> Self {
        match input {
            RewardInput::Observation => Self::Observation,
            RewardInput::ObservationAction => Self::ObservationAction,
        }
    }
}

impl Network {
    /// Inputs and outputs of each layer, first to last.
    pub(crate) fn layers(&self) -> impl Iterator<Item = (usize, usize)> {
        let widths = || self.widths.iter().map(|width| usize::from(*width));
        widths().zip(widths().skip(1))
    }

    /// Number of inputs, 0 if it has no width at all.
    pub(crate) fn inputs(&self) -> usize {
        self.widths.first().copied().map_or(0, usize::from)
    }

    /// Number of outputs, 0 if it has no width at all.
    pub(crate) fn outputs(&self) -> usize {
        self.widths.last().copied().map_or(0, usize::from)
    }

    /// The shape of a network. Widths are at most [`ted_core::MAX_WIDTH`], so they fit.
    #[cfg(feature = "std")]
    pub(crate) fn of(mlp: &Mlp<'_>) -> Self {
        let widths =
            core::iter::once(mlp.inputs()).chain(mlp.layers().map(|layer| layer.outputs()));
        Self {
            output: mlp.output().into(),
            widths: widths.map(|width| width as u16).collect(),
        }
    }
}
