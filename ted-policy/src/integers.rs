//! The networks in integers: what an artefact holds of them, and how it is read.

use heapless::Vec;
use ted_core::integer::{IntegerDense, IntegerError, IntegerMlp, IntegerPolicy, IntegerRange};
use ted_core::quantised::{QuantisedPolicy, QuantisedRewardEnsemble};
use ted_core::{MAX_LAYERS, Normaliser, ReturnThreshold};

use crate::arrays::Arrays;
use crate::metadata::RewardShape;
use crate::networks::check_widths;
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
) -> Option<QuantisedPolicy<'a>> {
    let mlp = mlp(arrays, network)?;
    let policy = arrays.integer(IntegerPolicy::new(
        fixed_point.input_fraction_bits,
        fixed_point.output_fraction_bits,
        mlp,
    ))?;
    arrays.integer(QuantisedPolicy::new(normaliser, policy).map_err(IntegerError::Shape))
}

/// Makes `into` the reward ensemble in integers behind the normaliser of the float one.
pub(crate) fn reward<'a>(
    arrays: &mut Arrays<'a>,
    integer: IntegerReward,
    shape: &RewardShape<'_>,
    normaliser: Normaliser<'a>,
    into: &mut QuantisedRewardEnsemble<'a>,
) -> Option<()> {
    let mut whole = true;
    let members = shape.members.iter().map_while(|network| {
        let member = mlp(arrays, &network);
        whole = member.is_some();
        member
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
    if !whole {
        return None;
    }
    arrays.integer(filled)
}

/// A network in integers: weights, biases, multipliers and shifts of each layer.
#[inline(never)]
fn mlp<'a>(arrays: &mut Arrays<'a>, network: &Network) -> Option<IntegerMlp<'a>> {
    let mut layers = Vec::<IntegerDense<'a>, MAX_LAYERS>::new();
    for (inputs, outputs) in network.layers() {
        arrays.integer(check_widths(inputs, outputs).map_err(IntegerError::Shape))?;
        let weights = arrays.take(inputs * outputs)?;
        let bias = arrays.take(outputs)?;
        let multipliers = arrays.take(outputs)?;
        let shifts = arrays.take(outputs)?;
        let layer = IntegerDense::new(inputs, weights, bias, multipliers, shifts);
        // There is room: a network has no more widths.
        layers.push(arrays.integer(layer)?).ok()?;
    }
    arrays.integer(IntegerMlp::new(&layers, network.output.into()).map_err(IntegerError::Shape))
}
