//! The loops that one writes first, and that a compiler has to make the best of.

use alloc::vec;
use alloc::vec::Vec;
use core::hint::black_box;

use ted_core::integer::tanh_q15;

use crate::network::{FRACTION_BITS, Layer, WIDTHS};
use crate::section;

/// The action in f32.
#[inline(never)]
pub fn f32(layers: &[Layer], x: &[f32]) -> Vec<f32> {
    let (mut a, mut b, mut action) = (
        vec![0.0; WIDTHS[1]],
        vec![0.0; WIDTHS[2]],
        vec![0.0; WIDTHS[3]],
    );
    let [first, second, last] = black_box(layers) else {
        unreachable!()
    };
    section::rest();
    layer_f32(first, x, &mut a, |v| if v > 0.0 { v } else { 0.0 });
    layer_f32(second, &a, &mut b, |v| if v > 0.0 { v } else { 0.0 });
    layer_f32(last, &b, &mut action, libm::tanhf);
    section::plain_f32();
    action
}

#[inline(always)]
fn layer_f32(layer: &Layer, x: &[f32], out: &mut [f32], activate: impl Fn(f32) -> f32) {
    for ((row, bias), out) in layer
        .weights
        .chunks_exact(x.len())
        .zip(&layer.bias)
        .zip(out)
    {
        let mut sum = *bias;
        for (w, x) in row.iter().zip(x) {
            sum += w * x;
        }
        *out = activate(sum);
    }
}

/// The action in integers, with 15 fraction bits.
#[inline(never)]
pub fn integer(layers: &[Layer], x: &[i16]) -> Vec<i16> {
    let (mut a, mut b, mut action) = (vec![0; WIDTHS[1]], vec![0; WIDTHS[2]], vec![0; WIDTHS[3]]);
    let [first, second, last] = black_box(layers) else {
        unreachable!()
    };
    section::rest();
    layer_integer(first, x, &mut a, |v| v.max(0));
    layer_integer(second, &a, &mut b, |v| v.max(0));
    layer_integer(last, &b, &mut action, |v| tanh_q15(v, FRACTION_BITS));
    section::plain_integer();
    action
}

/// The output of a reward model in integers, with 15 fraction bits. Not a section: it is there to compare with.
pub fn reward(layers: &[Layer], x: &[i16]) -> i32 {
    let (mut read, mut output) = (x.to_vec(), 0);
    for (index, layer) in layers.iter().enumerate() {
        let mut out = vec![0; layer.bias.len()];
        if index + 1 < layers.len() {
            layer_integer(layer, &read, &mut out, |v| v.max(0));
        } else {
            layer_integer(layer, &read, &mut out, |v| tanh_q15(v, FRACTION_BITS));
            output = i32::from(out[0]);
        }
        read = out;
    }
    output
}

/// One layer in integers.
#[inline(always)]
pub fn layer_integer(layer: &Layer, x: &[i16], out: &mut [i16], activate: impl Fn(i16) -> i16) {
    let scales = layer.multipliers.iter().zip(&layer.shifts);
    let rows = layer.weights_q.chunks_exact(x.len()).zip(&layer.bias_q);
    for (((row, bias), (&multiplier, &shift)), out) in rows.zip(scales).zip(out) {
        let mut acc = *bias;
        for (w, x) in row.iter().zip(x) {
            acc += i32::from(*w) * i32::from(*x);
        }
        let right = 31 - i32::from(shift);
        let y = (i64::from(acc) * i64::from(multiplier) + (1 << (right - 1))) >> right;
        *out = activate(y.clamp(-32767, 32767) as i16);
    }
}
