//! The networks in integers: what an artefact holds of them, and how it is read.

use heapless::Vec;
use ted_core::integer::{
    IntegerDense, IntegerError, IntegerMlp, IntegerPolicy, IntegerRange, IntegerRewardEnsemble,
};
use ted_core::quantised::{QuantisedPolicy, QuantisedRewardEnsemble};
use ted_core::{
    MAX_LAYERS, MAX_MEMBERS, Part, Policy, ReturnThreshold, RewardEnsemble, ShapeError, TedDiscount,
};

use crate::arrays::Arrays;
use crate::error::{ArtifactError, Place};
use crate::networks::{check_widths, too_many};
use crate::wire::{Integers, Network, Reward};

/// The networks of an artefact once more, in integers.
#[derive(Clone, Debug)]
pub struct IntegerNetworks<'a> {
    /// The policy.
    pub policy: QuantisedPolicy<'a>,
    /// The reward ensemble, if the artefact has one.
    pub reward: Option<QuantisedRewardEnsemble<'a>>,
    /// TED's border in the unit of the integer rewards, if the artefact has both an ensemble and a discount.
    pub threshold: Option<ReturnThreshold<i64>>,
}

/// The float networks that the integer ones stand beside: they lend them their normalisers.
#[derive(Clone, Copy)]
pub(crate) struct Originals<'o, 'a> {
    pub(crate) policy: &'o Policy<'a>,
    pub(crate) reward: Option<&'o RewardEnsemble<'a>>,
    pub(crate) ted: Option<&'o TedDiscount>,
}

/// Reads the integer networks: the shapes of the float ones, other numbers.
pub(crate) fn read<'a>(
    arrays: &mut Arrays<'a>,
    integers: &Integers,
    policy: &Network,
    reward: Option<&Reward>,
    originals: Originals<'_, 'a>,
) -> Result<IntegerNetworks<'a>, ArtifactError> {
    let fixed_point = &integers.policy;
    let integer_policy = IntegerPolicy::new(
        fixed_point.input_fraction_bits,
        fixed_point.output_fraction_bits,
        mlp(arrays, policy)?,
    )
    .map_err(ArtifactError::Integer)?;
    let ensemble = match (&integers.reward, reward) {
        (Some(integer), Some(reward)) => {
            let mut members = Vec::<IntegerMlp<'a>, MAX_MEMBERS>::new();
            for network in &reward.members {
                members
                    .push(mlp(arrays, network)?)
                    .map_err(|_| refused(too_many(Part::Members, MAX_MEMBERS)))?;
            }
            let range = IntegerRange {
                low: integer.low,
                high: integer.high,
            };
            let ensemble = IntegerRewardEnsemble::new(
                integer.fixed_point.input_fraction_bits,
                integer.fixed_point.output_fraction_bits,
                &members,
                range,
            );
            Some(ensemble.map_err(ArtifactError::Integer)?)
        }
        (None, None) => None,
        _ => {
            return Err(ArtifactError::IntegerPart {
                place: Place::Reward,
            });
        }
    };
    let threshold = integers.ted.map(|ted| ReturnThreshold {
        return_hat: ted.return_hat,
        last_tied_episode: ted.last_tied_episode,
    });
    join(integer_policy, ensemble, threshold, originals)
}

/// Puts the float networks' normalisers in front of the integer ones.
pub(crate) fn join<'a>(
    policy: IntegerPolicy<'a>,
    reward: Option<IntegerRewardEnsemble<'a>>,
    threshold: Option<ReturnThreshold<i64>>,
    originals: Originals<'_, 'a>,
) -> Result<IntegerNetworks<'a>, ArtifactError> {
    let policy = QuantisedPolicy::new(*originals.policy.normaliser(), policy).map_err(refused)?;
    let reward = match (reward, originals.reward) {
        (Some(integer), Some(reward)) => Some(
            QuantisedRewardEnsemble::new(reward.input(), *reward.normaliser(), integer)
                .map_err(refused)?,
        ),
        (None, None) => None,
        _ => {
            return Err(ArtifactError::IntegerPart {
                place: Place::Reward,
            });
        }
    };
    // A border is one of predicted returns: without an ensemble nobody here could compute them.
    if threshold.is_some() != (originals.ted.is_some() && reward.is_some()) {
        return Err(ArtifactError::IntegerPart {
            place: Place::Discount,
        });
    }
    Ok(IntegerNetworks {
        policy,
        reward,
        threshold,
    })
}

/// A network in integers: weights, biases, multipliers and shifts of each layer.
fn mlp<'a>(arrays: &mut Arrays<'a>, network: &Network) -> Result<IntegerMlp<'a>, ArtifactError> {
    let mut layers = Vec::<IntegerDense<'a>, MAX_LAYERS>::new();
    for (inputs, outputs) in network.layers() {
        check_widths(inputs, outputs).map_err(refused)?;
        let weights = arrays.take(inputs * outputs)?;
        let bias = arrays.take(outputs)?;
        let multipliers = arrays.take(outputs)?;
        let shifts = arrays.take(outputs)?;
        let layer = IntegerDense::new(inputs, weights, bias, multipliers, shifts)
            .map_err(ArtifactError::Integer)?;
        layers
            .push(layer)
            .map_err(|_| refused(too_many(Part::Layers, MAX_LAYERS)))?;
    }
    IntegerMlp::new(&layers, network.output.into()).map_err(refused)
}

fn refused(error: ShapeError) -> ArtifactError {
    ArtifactError::Integer(IntegerError::Shape(error))
}
