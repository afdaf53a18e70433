//! The integer dense kernel: four output rows at once, so that each activation is loaded once for four products.
//!
//! Integer sums have no rounding, so every order of additions gives the same bits: the compiler may vectorise as it likes, and
//! a kernel in another instruction set can be compared to the bit.

use super::dense::IntegerDense;
use super::requantise::requantise;

/// Rows computed together.
const ROWS: usize = 4;

/// Computes `out[o] = activate(requantise(bias[o] + sum_i weights[o][i] * x[i]))`.
#[inline(always)]
pub(super) fn dense(
    layer: &IntegerDense<'_>,
    x: &[i16],
    out: &mut [i16],
    activate: impl Fn(i16) -> i16,
) {
    let mut scales = layer.multipliers().iter().zip(layer.shifts());
    let mut finish = |out: &mut i16, acc: i32, bias: i32| {
        if let Some((&multiplier, &shift)) = scales.next() {
            *out = activate(requantise(acc.wrapping_add(bias), multiplier, shift));
        }
    };
    let mut rest = layer.weights();
    for (bias, out) in layer.bias().chunks(ROWS).zip(out.chunks_mut(ROWS)) {
        if let (&[a, b, c, d], Some((four, after))) = (bias, rest.split_at_checked(ROWS * x.len()))
        {
            let sums = dot_four(four, x);
            for ((out, acc), bias) in out.iter_mut().zip(sums).zip([a, b, c, d]) {
                finish(out, acc, bias);
            }
            rest = after;
        } else {
            for (out, &bias) in out.iter_mut().zip(bias) {
                let Some((row, after)) = rest.split_at_checked(x.len()) else {
                    return;
                };
                finish(out, dot(row, x), bias);
                rest = after;
            }
        }
    }
}

/// Dot products of four rows, one after the other in `weights`, with `x`.
#[inline(always)]
fn dot_four(weights: &[i8], x: &[i16]) -> [i32; ROWS] {
    let mut rows = [&[][..]; ROWS];
    for (row, weights) in rows.iter_mut().zip(weights.chunks_exact(x.len().max(1))) {
        *row = weights;
    }
    rows.map(|row| dot(row, x))
}

/// No sum overflows: [`IntegerDense`] has proved it for the largest weights and activations there are.
#[inline(always)]
fn dot(row: &[i8], x: &[i16]) -> i32 {
    let products = row
        .iter()
        .zip(x)
        .map(|(&w, &x)| i32::from(w) * i32::from(x));
    products.fold(0, i32::wrapping_add)
}
