//! Networks of many shapes through ted-core on the core itself, against the plainest code, to the bit.

use alloc::vec;
use alloc::vec::Vec;

use ted_core::integer::{IntegerDense, IntegerMlp, IntegerPolicy, IntegerScratch};
use ted_core::{Dense, Mlp, Output, Scratch, reference};

use crate::network::{FRACTION_BITS, Layer, Numbers};
use crate::plain;

/// Panics at the first shape whose bits differ.
pub fn compare() {
    for inputs in 1..=64_usize {
        let widths = [inputs, 4 * inputs - inputs % 5, 1 + inputs % 16];
        let mut numbers = Numbers::new(inputs as u32);
        let mut layers: Vec<Layer> = widths
            .windows(2)
            .map(|pair| Layer::random(pair[0], pair[1], &mut numbers))
            .collect();
        let x: Vec<f32> = (0..inputs).map(|_| numbers.next()).collect();
        f32(&layers, &x);
        integer(&layers, &x);
        // The largest sums there are.
        for layer in &mut layers {
            layer.weights_q.fill(-127);
        }
        integer(&layers, &vec![-1.0; inputs]);
    }
}

fn f32(layers: &[Layer], x: &[f32]) {
    let dense: Vec<Dense<'_>> = layers.iter().map(Layer::dense).collect();
    let mut computed = vec![f32::NAN; layers[1].bias.len()];
    let mlp = Mlp::new(&dense, Output::Linear).expect("the layers chain");
    mlp.forward(x, &mut Scratch::new(), &mut computed)
        .expect("the sizes fit");
    let layer = |layer: &Layer, x: &[f32]| -> Vec<f32> {
        let rows = layer.weights.chunks(layer.inputs).zip(&layer.bias);
        rows.map(|(row, bias)| reference::dense_row(row, *bias, x))
            .collect()
    };
    let hidden: Vec<f32> = layer(&layers[0], x).iter().map(|v| v.max(0.0)).collect();
    let expected = layer(&layers[1], &hidden);
    let bits = |values: &[f32]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&computed), bits(&expected), "{} inputs, f32", x.len());
}

fn integer(layers: &[Layer], x: &[f32]) {
    let x: Vec<i16> = x.iter().map(|v| (v * 32767.0) as i16).collect();
    let dense: Vec<IntegerDense<'_>> = layers.iter().map(Layer::integer).collect();
    let mlp = IntegerMlp::new(&dense, Output::Linear).expect("the layers chain");
    let policy = IntegerPolicy::new(FRACTION_BITS, FRACTION_BITS, mlp).expect("it fits");
    let mut computed = vec![7; layers[1].bias.len()];
    policy
        .act(&x, &mut IntegerScratch::new(), &mut computed)
        .expect("the sizes fit");
    let mut hidden = vec![0; layers[0].bias.len()];
    let mut expected = vec![0; computed.len()];
    plain::layer_integer(&layers[0], &x, &mut hidden, |y| y.max(0));
    plain::layer_integer(&layers[1], &hidden, &mut expected, |y| y);
    assert_eq!(computed, expected, "{} inputs, integers", x.len());
}
