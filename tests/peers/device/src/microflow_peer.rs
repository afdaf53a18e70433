//! microflow's fully-connected kernel: 8-bit weights and activations, one scale per tensor, requantised in f32.

use alloc::boxed::Box;
use alloc::vec::Vec;
use core::hint::black_box;

use microflow::activation::FusedActivation;
use microflow::buffer::Buffer2D;
use microflow::ops::{FullyConnectedOptions, fully_connected};
use microflow::tensor::Tensor2D;

use crate::network::{Layer, largest};
use crate::section;

/// What the last layer reaches before its tanh, which microflow does not have, in f32.
#[inline(never)]
pub fn int8(layers: &[Layer], x: &[f32]) -> Vec<f32> {
    let [first, second, last] = layers else {
        unreachable!()
    };
    // Of the activations, wide enough for this network.
    let scales = [largest(x) / 127.0, 8.0 / 127.0, 8.0 / 127.0, 8.0 / 127.0];
    let one = Parameters::<39, 256>::new(first, scales[0], scales[1]);
    let two = Parameters::<256, 256>::new(second, scales[1], scales[2]);
    let three = Parameters::<256, 4>::new(last, scales[2], scales[3]);
    let x = Tensor2D::quantize(Buffer2D::<f32, 1, 39>::from_row_slice(x), [scales[0]], [0]);
    let (one, two, three) = black_box((&one, &two, &three));
    section::rest();
    let a = one.apply(x, FusedActivation::Relu);
    let b = two.apply(a, FusedActivation::Relu);
    let y = three.apply(b, FusedActivation::None);
    section::microflow_int8();
    y.dequantize().iter().copied().collect()
}

struct Parameters<const I: usize, const O: usize> {
    weights: Box<Tensor2D<i8, I, O, 1>>,
    bias: Buffer2D<f32, O, 1>,
    factor: f32,
    scale: f32,
}

impl<const I: usize, const O: usize> Parameters<I, O> {
    fn new(layer: &Layer, input_scale: f32, output_scale: f32) -> Self {
        let scale = largest(&layer.weights) / 127.0;
        let weights =
            Buffer2D::from_fn(|i, o| libm::roundf(layer.weights[o * I + i] / scale) as i8);
        Self {
            weights: Box::new(Tensor2D::new(weights, [scale], [0])),
            bias: Buffer2D::from_fn(|o, _| layer.bias[o] / output_scale),
            factor: input_scale * scale / output_scale,
            scale: output_scale,
        }
    }

    #[inline(always)]
    fn apply(
        &self,
        x: Tensor2D<i8, 1, I, 1>,
        fused_activation: FusedActivation,
    ) -> Tensor2D<i8, 1, O, 1> {
        let options = FullyConnectedOptions { fused_activation };
        // Every zero point is zero, so what corrects for them is too.
        let constants = (self.bias, self.factor, Buffer2D::zeros(), 0);
        fully_connected(x, &self.weights, [self.scale], [0], options, constants)
    }
}
