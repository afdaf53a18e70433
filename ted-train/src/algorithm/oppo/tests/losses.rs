//! Each loss by hand, and its gradient by central differences.

use crate::algorithm::oppo::losses::{excess_length, squared_error, triplet};
use crate::algorithm::oppo::update::clip;
use crate::nn::Backend;
use crate::nn::fixtures::{assert_close, numbers, tensor, values, wide};
use crate::nn::scalar::central_differences;

#[test]
fn a_triplet_costs_what_the_better_clip_is_not_nearer_by_the_margin() {
    // Distances from the origin: first clips, then second ones.
    let latents = [3.0, 5.0, 4.0, 4.0, 2.0, 3.5, 3.0, 1.0, 2.0, 4.0];
    let triplet_of =
        |first: f32, second: f32, label: f32| triplet(&[0.0], &[first, second], &[label], 1.0).loss;
    let by_hand = [
        (3.0, 5.0, 0.0, 0.0),
        (5.0, 3.0, 0.0, 3.0),
        (3.0, 3.5, 0.0, 0.5),
        (4.0, 1.0, 1.0, 0.0),
        (1.0, 4.0, 1.0, 4.0),
        (4.0, 2.0, 0.5, 2.0),
        (2.0, 4.0, 0.5, 0.0),
    ];
    for (first, second, label, loss) in by_hand {
        let actual = triplet_of(first, second, label);
        assert_close(
            &[actual],
            &[loss],
            1e-5,
            &format!("{first} {second} {label}"),
        );
    }
    // The mean over pairs.
    let all = triplet(&[0.0], &latents, &[0.0, 0.0, 1.0, 0.5, 0.5], 1.0);
    let expected = [
        3.0 - 3.5 + 1.0,
        5.0 - 3.0 + 1.0,
        1.0 - 4.0 + 1.0,
        4.0 - 2.0,
        2.0 - 4.0,
    ];
    let mean = expected.iter().map(|x: &f64| x.max(0.0)).sum::<f64>() / 5.0;
    assert_close(&[all.loss], &[mean], 1e-5, "mean");
}

#[test]
fn the_gradients_of_the_triplet_loss_are_its_differences() {
    const SIZE: usize = 3;
    let labels = [0.0, 1.0, 0.5, 1.0];
    let (anchor, latents) = (numbers(SIZE, "anchor"), numbers(8 * SIZE, "latents"));
    let loss = |anchor: &[f64], latents: &[f64]| -> f64 {
        let distance = |at: usize| -> f64 {
            let z = &latents[at * SIZE..][..SIZE];
            let square = |(a, z): (&f64, &f64)| (a - z + 1e-6).powi(2);
            anchor.iter().zip(z).map(square).sum::<f64>().sqrt()
        };
        let term = |pair: usize| -> f64 {
            let (first, second) = (distance(pair), distance(4 + pair));
            match labels[pair] {
                0.0 => first - second + 1.0,
                1.0 => second - first + 1.0,
                _ => first - second,
            }
        };
        (0..4).map(|pair| term(pair).max(0.0)).sum::<f64>() / 4.0
    };
    let actual = triplet(&anchor, &latents, &labels, 1.0);
    let (anchor, latents) = (wide(&anchor), wide(&latents));
    assert_close(&[actual.loss], &[loss(&anchor, &latents)], 1e-6, "loss");
    let expected = central_differences(&anchor, |anchor| loss(anchor, &latents));
    assert_close(&actual.d_anchor, &expected, 1e-5, "anchor");
    let expected = central_differences(&latents, |latents| loss(&anchor, latents));
    assert_close(&actual.d_latents, &expected, 1e-5, "latents");
}

#[test]
fn latents_cost_what_they_are_longer_than_one() {
    // Lengths 5, 0.5 of first clips, 13, 1 of second ones.
    let latents = [3.0, 4.0, 0.3, 0.4, 5.0, 12.0, 0.0, 1.0];
    let (loss, gradient) = excess_length(&latents, 2);
    assert_close(&[loss], &[(4.0 + 12.0) / 2.0], 1e-6, "loss");
    let expected = [0.6, 0.8, 0.0, 0.0, 5.0 / 13.0, 12.0 / 13.0, 0.0, 0.0].map(|d| d / 2.0);
    assert_close(&gradient, &expected, 1e-6, "gradient");
}

#[test]
fn the_squared_error_is_a_mean() {
    let of = |values: &[f32]| tensor(values, [1, 2, 2], Backend::Flex);
    let (loss, gradient) = squared_error(of(&[1.0, 2.0, 3.0, 4.0]), of(&[0.0, 2.0, 5.0, 4.0]));
    assert_close(&[loss], &[5.0 / 4.0], 1e-6, "loss");
    assert_close(&values(gradient), &[0.5, 0.0, -1.0, 0.0], 1e-6, "gradient");
}

#[test]
fn a_long_gradient_is_shortened_and_a_short_one_is_not() {
    let of = |values: [f32; 2]| tensor(&values, [1, 1, 2], Backend::Flex);
    for (limit, factor) in [(6.5, 0.5), (13.0, 1.0), (20.0, 1.0)] {
        let (mut a, mut b) = (of([3.0, 4.0]), of([0.0, 12.0]));
        clip(vec![&mut a, &mut b], limit);
        let all = [values(a), values(b)].concat();
        let expected = [3.0, 4.0, 0.0, 12.0].map(|x| factor * x);
        assert_close(&all, &expected, 1e-6, "gradient");
    }
}
