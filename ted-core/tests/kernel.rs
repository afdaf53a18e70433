//! The fast kernel has the bits of the plain reference, for every shape.

use proptest::prelude::*;
use ted_core::{Dense, MAX_WIDTH, Mlp, Output, Scratch, activation, reference};

/// Reproducible numbers in (-1, 1) that use all bits of the mantissa.
fn numbers(count: usize, seed: u64) -> Vec<f32> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 40) as f32 / (1 << 23) as f32 - 1.0
    };
    (0..count).map(|_| next()).collect()
}

fn bits(values: &[f32]) -> Vec<u32> {
    values.iter().map(|value| value.to_bits()).collect()
}

/// What [`Mlp::forward`] has to compute, layer by layer with the reference.
fn plain(layers: &[Dense<'_>], output: Output, x: &[f32]) -> Vec<f32> {
    let mut values = x.to_vec();
    for (index, layer) in layers.iter().enumerate() {
        let rows = layer.weights().chunks(layer.inputs()).zip(layer.bias());
        let sums = rows.map(|(row, bias)| reference::dense_row(row, *bias, &values));
        values = match output {
            _ if index + 1 < layers.len() => sums.map(activation::relu).collect(),
            Output::Linear => sums.collect(),
            Output::Tanh => sums.map(activation::tanh).collect(),
        };
    }
    values
}

fn assert_same_bits(widths: &[usize], output: Output, seed: u64) {
    let parameters: Vec<_> = widths
        .windows(2)
        .enumerate()
        .map(|(layer, pair)| {
            let seed = seed + 10 * layer as u64;
            (
                pair[0],
                pair[1],
                numbers(pair[0] * pair[1], seed),
                numbers(pair[1], seed + 1),
            )
        })
        .collect();
    let layers: Vec<_> = parameters
        .iter()
        .map(|(i, o, weights, bias)| Dense::new(*i, *o, weights, bias).unwrap())
        .collect();
    let x = numbers(widths[0], seed + 2);
    let mut out = vec![f32::NAN; *widths.last().unwrap()];
    Mlp::new(&layers, output)
        .unwrap()
        .forward(&x, &mut Scratch::new(), &mut out)
        .unwrap();
    assert_eq!(bits(&out), bits(&plain(&layers, output, &x)), "{widths:?}");
}

#[test]
fn every_small_shape_has_the_bits_of_the_reference() {
    for inputs in 1..=20 {
        for outputs in 1..=20 {
            assert_same_bits(&[inputs, outputs], Output::Linear, 3);
        }
    }
}

#[test]
fn the_shapes_that_fly_have_the_bits_of_the_reference() {
    assert_same_bits(&[39, 256, 256, 4], Output::Tanh, 1);
    assert_same_bits(&[43, 256, 256, 1], Output::Linear, 2);
    assert_same_bits(&[MAX_WIDTH; 5], Output::Tanh, 3);
}

proptest! {
    #[test]
    fn any_network_has_the_bits_of_the_reference(
        widths in prop::collection::vec(1_usize..70, 2..=5),
        tanh: bool,
        seed in 0..u64::MAX / 2,
    ) {
        let output = if tanh { Output::Tanh } else { Output::Linear };
        assert_same_bits(&widths, output, seed);
    }

    #[test]
    fn extreme_numbers_have_the_bits_of_the_reference(
        (inputs, weights, x) in (1_usize..40).prop_flat_map(|inputs| {
            let finite = || {
                prop_oneof![
                    -1e3_f32..1e3,
                    -1e-38_f32..1e-38,
                    prop::num::f32::SUBNORMAL | prop::num::f32::ZERO,
                    Just(-0.0_f32),
                    Just(1e18_f32),
                ]
            };
            let numbers = |count| prop::collection::vec(finite(), count);
            (Just(inputs), numbers(inputs * 13), numbers(inputs))
        }),
    ) {
        let some = [-0.0, 0.0, 1e-40, 1.0, -1e30];
        let bias: Vec<f32> = some.into_iter().cycle().take(13).collect();
        let layer = Dense::new(inputs, 13, &weights, &bias).unwrap();
        let mut out = [f32::NAN; 13];
        Mlp::new(&[layer], Output::Linear).unwrap().forward(&x, &mut Scratch::new(), &mut out).unwrap();
        prop_assert_eq!(bits(&out), bits(&plain(&[layer], Output::Linear, &x)));
    }
}

#[test]
fn the_reference_adds_in_four_lanes_and_not_in_one_sequence() {
    // 2^24 swallows a 1 that is added to it; which ones survive shows the order.
    let big = 16_777_216.0;
    let x = [big, 1.0, 1.0, 1.0, 1.0, -big];
    // Lanes: 2^24 + 1 = 2^24; 1 - 2^24; 1; 1. Together (2^24 + (1 - 2^24)) + (1 + 1).
    assert_eq!(reference::dense_row(&[1.0; 6], 0.5, &x), 3.5);
    assert_eq!(x.iter().sum::<f32>(), 0.0);
}
