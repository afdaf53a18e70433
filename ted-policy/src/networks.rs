//! Joins shapes from the metadata and numbers from the blob into `ted-core` types.

use heapless::Vec;
use ted_core::{
    Dense, MAX_LAYERS, MAX_WIDTH, Mlp, Normaliser, Part, RewardEnsemble, RewardInput, RewardRange,
    ShapeError, TedDiscount,
};

use crate::arrays::Arrays;
use crate::error::{ArtifactError, Place};
use crate::metadata::{RewardShape, Terms};
use crate::wire::{Network, Ted};

/// Passes when the policy reads the contract's observation and writes its action.
///
/// Checked before the blob is cut, so that a wrong shape is called that and not a wrong number.
pub(crate) fn fits(
    network: &Network,
    observation: usize,
    action: usize,
) -> Result<(), ArtifactError> {
    let place = Place::Policy;
    for (part, expected, actual) in [
        (Part::Observation, observation, network.inputs()),
        (Part::Action, action, network.outputs()),
    ] {
        if expected != actual {
            let error = ShapeError::Mismatch {
                part,
                expected,
                actual,
            };
            return Err(ArtifactError::Shape { place, error });
        }
    }
    Ok(())
}

/// A normaliser of so many channels: finite shifts, then finite and positive scales.
pub(crate) fn normaliser<'a>(
    arrays: &mut Arrays<'a>,
    channels: usize,
    place: Place,
) -> Option<Normaliser<'a>> {
    let shift = arrays.take_f32(channels, place)?;
    let scale = arrays.take_f32(channels, place)?;
    if let Some(channel) = scale.iter().position(|scale| *scale <= 0.0) {
        return arrays.refuse(ArtifactError::ScaleNotPositive { place, channel });
    }
    arrays.shaped(place, Normaliser::new(shift, scale))
}

/// A network: weights and biases of each layer.
pub(crate) fn mlp<'a>(arrays: &mut Arrays<'a>, network: &Network, place: Place) -> Option<Mlp<'a>> {
    let mut layers = Vec::<Dense<'a>, MAX_LAYERS>::new();
    for (inputs, outputs) in network.layers() {
        arrays.shaped(place, check_widths(inputs, outputs))?;
        let weights = arrays.take_f32(inputs * outputs, place)?;
        let bias = arrays.take_f32(outputs, place)?;
        let layer = arrays.shaped(place, Dense::new(inputs, outputs, weights, bias))?;
        // There is room: a network has no more widths.
        layers.push(layer).ok()?;
    }
    arrays.shaped(place, Mlp::new(&layers, network.output.into()))
}

/// Makes `into` a reward ensemble that sees what the contract has.
pub(crate) fn reward<'a>(
    arrays: &mut Arrays<'a>,
    reward: &RewardShape<'_>,
    terms: &Terms<'_>,
    into: &mut RewardEnsemble<'a>,
) -> Option<()> {
    let range = RewardRange {
        low: reward.low,
        high: reward.high,
    };
    // A width beyond every float would make rewards that are no number.
    if !(range.low <= range.high && (range.high - range.low).is_finite()) {
        return arrays.refuse(ArtifactError::RewardRange {
            low: range.low,
            high: range.high,
        });
    }
    let input = RewardInput::from(reward.input);
    let seen = reward.inputs(terms);
    for (index, network) in reward.members.iter().enumerate() {
        if network.inputs() != seen {
            let error = ShapeError::Mismatch {
                part: Part::Inputs,
                expected: seen,
                actual: network.inputs(),
            };
            return arrays.shaped(Place::RewardMember(index as u8), Err(error));
        }
    }
    let normaliser = normaliser(arrays, seen, Place::RewardNormaliser)?;
    let (mut index, mut whole) = (0, true);
    let members = reward.members.iter().map_while(|network| {
        let member = mlp(arrays, &network, Place::RewardMember(index));
        index += 1;
        whole = member.is_some();
        member
    });
    let filled = into.fill(input, normaliser, members, range);
    if !whole {
        return None;
    }
    arrays.shaped(Place::Reward, filled)
}

/// A discount whose numbers are in range.
pub(crate) fn ted(ted: &Ted) -> Result<TedDiscount, ArtifactError> {
    let threshold = ted_core::ReturnThreshold {
        return_hat: ted.return_hat,
        last_tied_episode: ted.last_tied_episode,
    };
    TedDiscount::new(ted.gamma, ted.sigma, threshold).map_err(ArtifactError::Discount)
}

/// Checked before the product is formed, so that it cannot overflow.
pub(crate) fn check_widths(inputs: usize, outputs: usize) -> Result<(), ShapeError> {
    for (part, actual) in [(Part::Inputs, inputs), (Part::Outputs, outputs)] {
        if actual > MAX_WIDTH {
            return Err(ShapeError::TooLarge {
                part,
                limit: MAX_WIDTH,
                actual,
            });
        }
    }
    Ok(())
}
