//! The networks in integers: what an artefact holds of them, and how it is read.

use heapless::Vec;
use ted_core::integer::{IntegerDense, IntegerError, IntegerMlp, IntegerPolicy, IntegerRange};
use ted_core::quantised::{QuantisedPolicy, QuantisedRewardEnsemble};
use ted_core::{MAX_LAYERS, Normaliser, Part, ReturnThreshold, ShapeError};

use crate::arrays::Arrays;
use crate::error::ArtifactError;
use crate::metadata::RewardShape;
use crate::networks::{check_widths, too_many};
use crate::wire::{FixedPoint, IntegerReward, Network};

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

/// Reads the policy in integers behind the normaliser of the float one.
pub(crate) fn policy<'a>(
    arrays: &mut Arrays<'a>,
    fixed_point: FixedPoint,
    network: &Network,
    normaliser: Normaliser<'a>,
) -> Result<QuantisedPolicy<'a>, ArtifactError> {
    let policy = IntegerPolicy::new(
        fixed_point.input_fraction_bits,
        fixed_point.output_fraction_bits,
        mlp(arrays, network)?,
    )
    .map_err(ArtifactError::Integer)?;
    QuantisedPolicy::new(normaliser, policy).map_err(refused)
}

/// Makes `into` the reward ensemble in integers behind the normaliser of the float one.
pub(crate) fn reward<'a>(
    arrays: &mut Arrays<'a>,
    integer: IntegerReward,
    shape: &RewardShape<'_>,
    normaliser: Normaliser<'a>,
    into: &mut QuantisedRewardEnsemble<'a>,
) -> Result<(), ArtifactError> {
    let mut defect = None;
    let members = shape.members.iter().map_while(|network| {
        mlp(arrays, &network)
            .map_err(|error| defect = Some(error))
            .ok()
    });
    let range = IntegerRange {
        low: integer.low,
        high: integer.high,
    };
    let FixedPoint {
        input_fraction_bits,
        output_fraction_bits,
    } = integer.fixed_point;
    let filled = into.fill(shape.input.into(), normaliser, |ensemble| {
        ensemble.fill(input_fraction_bits, output_fraction_bits, members, range)
    });
    match defect {
        Some(error) => Err(error),
        None => filled.map_err(ArtifactError::Integer),
    }
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
