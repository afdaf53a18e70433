//! What a transition was worth, and what that makes it weigh: plain numbers, an episode or a dataset at a time.

use crate::filter::Kept;

/// TD(lambda) returns of one episode, each step with a discount of its own:
/// `R_t = r_t + gamma_t [(1 - lambda) V_t+1 + lambda R_t+1]`.
///
/// `values` has one more number than `rewards` and `discounts`: the value of every observation, the last one's included. It stands
/// for everything after the recording; a discount of 0 after a terminal leaves it out.
pub(super) fn lambda_returns(
    rewards: &[f32],
    discounts: &[f32],
    values: &[f32],
    lambda: f64,
) -> Vec<f64> {
    let mut returns = vec![0.0; rewards.len()];
    let mut ahead = values.last().map_or(0.0, |&v| f64::from(v));
    let steps = rewards.iter().zip(discounts).zip(&values[1..]);
    for (out, ((&reward, &discount), &value)) in returns.iter_mut().zip(steps).rev() {
        let look = (1.0 - lambda) * f64::from(value) + lambda * ahead;
        ahead = f64::from(reward) + f64::from(discount) * look;
        *out = ahead;
    }
    returns
}

/// Added to the standard deviation of the advantages, so that equal ones weigh one.
const STD_FLOOR: f64 = 1e-5;

/// `min(exp(normalised advantage / temperature), clip)`, normalised over those of the transitions that may be drawn.
pub(super) fn advantage_weights(
    advantages: &[f64],
    kept: &Kept,
    temperature: f64,
    clip: f64,
) -> Vec<f32> {
    let drawn = || (0..kept.count()).map(|index| advantages[kept.step(index)]);
    let count = kept.count() as f64;
    let mean = drawn().sum::<f64>() / count;
    let squares = drawn().map(|a| (a - mean) * (a - mean));
    let std = (squares.sum::<f64>() / count).sqrt();
    let weight = |a: &f64| {
        let normalised = (a - mean) / (std + STD_FLOOR);
        let weight = (normalised / temperature).exp();
        // Not `min`, which would make the largest weight of what is not a number: a V that diverged has to be noticed.
        (if weight > clip { clip } else { weight }) as f32
    };
    advantages.iter().map(weight).collect()
}
