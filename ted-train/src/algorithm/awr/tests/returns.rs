//! TD(lambda) with a discount for each transition, and the weights of advantages, by hand.

use crate::algorithm::awr::{advantage_weights, lambda_returns};
use crate::dataset::Dataset;
use crate::dataset::fixtures::{SHAPE, records};
use crate::filter::{FilterConfig, Kept};
use crate::nn::fixtures::assert_close;

const REWARDS: [f32; 3] = [1.0, 2.0, 3.0];
const VALUES: [f32; 4] = [10.0, 20.0, 30.0, 40.0];

#[test]
fn returns_look_ahead_through_each_transition_s_own_discount() {
    // From the end: 3 + 0.5 * 40; 2 + 0.25 (0.5 * 30 + 0.5 * 23); 1 + 0.5 (0.5 * 20 + 0.5 * 8.625).
    let returns = lambda_returns(&REWARDS, &[0.5, 0.25, 0.5], &VALUES, 0.5);
    assert_eq!(returns, [8.15625, 8.625, 23.0]);
}

#[test]
fn nothing_is_seen_beyond_a_terminal() {
    // 3; 2 + 0.25 (0.5 * 30 + 0.5 * 3); 1 + 0.5 (0.5 * 20 + 0.5 * 6.125).
    let returns = lambda_returns(&REWARDS, &[0.5, 0.25, 0.0], &VALUES, 0.5);
    assert_eq!(returns, [7.53125, 6.125, 3.0]);
}

#[test]
fn lambda_goes_from_one_step_ahead_to_the_end_of_the_recording() {
    let discounts = [0.5, 0.25, 0.5];
    let one_step = lambda_returns(&REWARDS, &discounts, &VALUES, 0.0);
    assert_eq!(one_step, [1.0 + 10.0, 2.0 + 7.5, 3.0 + 20.0]);
    let to_the_end = lambda_returns(&REWARDS, &discounts, &VALUES, 1.0);
    assert_eq!(to_the_end, [1.0 + 0.5 * 7.75, 2.0 + 0.25 * 23.0, 23.0]);
}

#[test]
fn weights_are_exponentials_of_normalised_advantages_up_to_the_clip() {
    let (all, _) = kept();
    // Mean 2, standard deviation 1.
    let weights = advantage_weights(&[1.0, 3.0, 1.0, 3.0], &all, 0.5, 20.0);
    assert_close(&weights[..2], &[(-2f64).exp(), 2f64.exp()], 1e-4, "weights");
    let clipped = advantage_weights(&[1.0, 3.0, 1.0, 3.0], &all, 0.5, 4.0);
    assert_eq!((clipped[0], clipped[1]), (weights[0], 4.0));
    assert_eq!(advantage_weights(&[5.0; 4], &all, 1.0, 20.0), [1.0; 4]);
}

#[test]
fn a_value_that_diverged_is_no_large_weight() {
    let (all, _) = kept();
    let weights = advantage_weights(&[1.0, f64::NAN, 1.0, 3.0], &all, 1.0, 20.0);
    assert!(weights.iter().all(|weight| weight.is_nan()), "{weights:?}");
}

#[test]
fn advantages_are_normalised_over_what_may_be_drawn() {
    let (_, first_episode) = kept();
    // The other two are as large as one likes.
    let weights = advantage_weights(&[1.0, 3.0, 900.0, -900.0], &first_episode, 0.5, 20.0);
    assert_close(&weights[..2], &[(-2f64).exp(), 2f64.exp()], 1e-4, "weights");
}

/// All transitions of two episodes of two steps each, and those of the first.
fn kept() -> (Kept, Kept) {
    let dataset = Dataset::from_records("ted/x-v0", SHAPE, &records(&[2, 2])).unwrap();
    let of = |filter: FilterConfig| filter.kept(&dataset, &[1.0, 0.0]).unwrap();
    let first = of(FilterConfig::TopPredicted { k: 50.0 });
    (of(FilterConfig::All {}), first)
}
