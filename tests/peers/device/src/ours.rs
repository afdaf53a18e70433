//! ted-core's policies, whole: standardisation, every layer, the final tanh.

use alloc::vec;
use alloc::vec::Vec;
use core::hint::black_box;

use ted_core::integer::{IntegerDense, IntegerMlp, IntegerPolicy, IntegerScratch};
use ted_core::{Dense, Mlp, Normaliser, Output, Policy, Scratch};

use crate::network::{FRACTION_BITS, Layer, WIDTHS};
use crate::section;

/// The action in f32.
#[inline(never)]
pub fn f32(layers: &[Layer], x: &[f32]) -> Vec<f32> {
    let (shift, scale) = ([0.0; WIDTHS[0]], [1.0; WIDTHS[0]]);
    let layers: Vec<Dense<'_>> = layers.iter().map(Layer::dense).collect();
    let mlp = Mlp::new(&layers, Output::Tanh).expect("the layers chain");
    let policy =
        Policy::new(Normaliser::new(&shift, &scale).expect("finite"), mlp).expect("it fits");
    let mut scratch = Scratch::new();
    let mut action = vec![0.0; WIDTHS[3]];
    let (policy, x) = black_box((&policy, x));
    section::rest();
    let done = policy.act(x, &mut scratch, &mut action);
    section::ours_f32();
    done.expect("the sizes fit");
    action
}

/// The action in integers, with 15 fraction bits.
#[inline(never)]
pub fn integer(layers: &[Layer], x: &[i16]) -> Vec<i16> {
    let layers: Vec<IntegerDense<'_>> = layers.iter().map(Layer::integer).collect();
    let mlp = IntegerMlp::new(&layers, Output::Tanh).expect("the layers chain");
    let policy = IntegerPolicy::new(FRACTION_BITS, FRACTION_BITS, mlp).expect("it fits");
    let mut scratch = IntegerScratch::new();
    let mut action = vec![0; WIDTHS[3]];
    let (policy, x) = black_box((&policy, x));
    section::rest();
    let done = policy.act(x, &mut scratch, &mut action);
    section::ours_integer();
    done.expect("the sizes fit");
    action
}
