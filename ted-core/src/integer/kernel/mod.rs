//! The integer dense kernel: four output rows at a time, over one of four dot products.
//!
//! Integer sums have no rounding, so every order of additions gives the same bits, and each kind of machine may have the
//! order that suits it. Nothing here can panic: rows are cut by iterators, and what is missing ends the loop.
//! [`IntegerDense`] has proved that nothing is, and that no sum overflows.

#[cfg(any(test, all(target_arch = "arm", feature = "cortex-m")))]
mod dsp;
#[cfg(any(
    test,
    all(
        not(target_pointer_width = "64"),
        not(all(target_arch = "arm", feature = "cortex-m"))
    )
))]
mod scalar;
#[cfg(any(test, target_pointer_width = "64"))]
mod vector;
#[cfg(all(target_arch = "x86_64", target_pointer_width = "64"))]
mod wide;

#[cfg(all(target_arch = "arm", feature = "cortex-m"))]
use dsp::Activations;
#[cfg(all(
    not(target_pointer_width = "64"),
    not(all(target_arch = "arm", feature = "cortex-m"))
))]
use scalar::Activations;
#[cfg(all(target_pointer_width = "64", not(target_arch = "x86_64")))]
use vector::Activations;
#[cfg(all(target_arch = "x86_64", target_pointer_width = "64"))]
use wide::Activations;

use super::dense::IntegerDense;
use super::requantise::requantise;

/// Rows computed together: their scales are read in one go, and a core without vector registers reads each activation once
/// for several.
const ROWS: usize = 4;

/// Computes `out[o] = max(requantise(bias[o] + sum_i weights[o][i] * x[i]), least)`: a ReLU where `least` is zero.
///
/// Out of line: copied into a network's loop over its layers, it has too few registers left.
#[inline(never)]
pub(super) fn dense(layer: &IntegerDense<'_>, x: &[i16], out: &mut [i16], least: i16) {
    let inputs = x.len().max(1);
    let mut activations = Activations::new();
    activations.take(x);
    let groups = layer.weights().chunks_exact(ROWS * inputs);
    let odd_rows = groups.remainder().chunks_exact(inputs);
    let (bias, odd_bias) = layer.bias().as_chunks::<ROWS>();
    let (multipliers, odd_multipliers) = layer.multipliers().as_chunks::<ROWS>();
    let (shifts, odd_shifts) = layer.shifts().as_chunks::<ROWS>();
    let (out, odd_out) = out.as_chunks_mut::<ROWS>();
    let scales = multipliers.iter().zip(shifts);
    for (((rows, bias), out), (multipliers, shifts)) in groups.zip(bias).zip(out).zip(scales) {
        let mut sums = *bias;
        activations.add_dot(rows, x, &mut sums);
        let scales = multipliers.iter().zip(shifts);
        for ((out, acc), (&multiplier, &shift)) in out.iter_mut().zip(sums).zip(scales) {
            *out = requantise(acc, multiplier, shift, least);
        }
    }
    let odd = odd_rows.zip(odd_bias).zip(odd_out);
    for (((row, &bias), out), (&multiplier, &shift)) in
        odd.zip(odd_multipliers.iter().zip(odd_shifts))
    {
        *out = requantise(bias.wrapping_add(dot(row, x)), multiplier, shift, least);
    }
}

/// The dot product of what little is left over.
#[inline(never)]
fn dot(row: &[i8], x: &[i16]) -> i32 {
    let products = row
        .iter()
        .zip(x)
        .map(|(&w, &x)| i32::from(w) * i32::from(x));
    products.fold(0, i32::wrapping_add)
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use proptest::prelude::*;

    #[cfg(target_arch = "x86_64")]
    use super::wide;
    use super::{ROWS, dot, dsp, scalar, vector};
    use crate::integer::{MAX_ACTIVATION, MAX_WEIGHT};
    use crate::limits::MAX_WIDTH;

    fn rows_and_input() -> impl Strategy<Value = (Vec<i8>, Vec<i16>)> {
        let width = prop_oneof![3 => 1..=40_usize, 1 => Just(MAX_WIDTH)];
        width.prop_flat_map(|inputs| {
            let w = prop_oneof![3 => -MAX_WEIGHT..=MAX_WEIGHT, 1 => Just(-MAX_WEIGHT)];
            let x = prop_oneof![3 => -MAX_ACTIVATION..=MAX_ACTIVATION, 1 => Just(-MAX_ACTIVATION)];
            (
                prop::collection::vec(w, ROWS * inputs),
                prop::collection::vec(x, inputs),
            )
        })
    }

    proptest! {
        #[test]
        fn every_dot_product_has_the_same_bits((rows, x) in rows_and_input(), sum: i16) {
            let start = [i32::from(sum); ROWS];
            let mut expected = start;
            for (sum, row) in expected.iter_mut().zip(rows.chunks(x.len())) {
                *sum += dot(row, &x);
            }
            let mut by_vectors = start;
            vector::Activations::new().add_dot(&rows, &x, &mut by_vectors);
            prop_assert_eq!(by_vectors, expected);
            let mut by_words = start;
            let mut activations = scalar::Activations::new();
            activations.take(&x);
            activations.add_dot(&rows, &x, &mut by_words);
            prop_assert_eq!(by_words, expected);
            #[cfg(target_arch = "x86_64")]
            {
                let mut by_registers = start;
                let mut activations = wide::Activations::new();
                activations.take(&x);
                activations.add_dot(&rows, &x, &mut by_registers);
                prop_assert_eq!(by_registers, expected);
            }
            let mut by_pairs = start;
            let mut activations = dsp::Activations::new();
            activations.take(&x);
            activations.add_dot(&rows, &x, &mut by_pairs);
            prop_assert_eq!(by_pairs, expected);
        }
    }
}
