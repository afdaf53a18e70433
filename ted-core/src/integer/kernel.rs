//! The integer dense kernel, in the plainest code there is.
//!
//! Integer sums have no rounding, so every order of additions gives the same bits: the compiler may vectorise as it likes, and
//! a kernel in another instruction set can be compared to the bit.

use super::dense::IntegerDense;
use super::requantise::requantise;

/// Computes `out[o] = activate(requantise(bias[o] + sum_i weights[o][i] * x[i]))`.
#[inline(always)]
pub(super) fn dense(
    layer: &IntegerDense<'_>,
    x: &[i16],
    out: &mut [i16],
    activate: impl Fn(i16) -> i16,
) {
    let rows = layer.weights().chunks_exact(x.len().max(1));
    let scales = layer.multipliers().iter().zip(layer.shifts());
    for (((row, &bias), (&multiplier, &shift)), out) in rows.zip(layer.bias()).zip(scales).zip(out)
    {
        // No sum overflows: the layer has proved it for the largest weights and activations there are.
        let products = row
            .iter()
            .zip(x)
            .map(|(&w, &x)| i32::from(w) * i32::from(x));
        let acc = products.fold(bias, i32::wrapping_add);
        *out = activate(requantise(acc, multiplier, shift));
    }
}
