//! A dense layer: first weights, forward, backward.

use burn::tensor::{Device, Tensor, TensorData};
use rand::Rng;

use crate::nn::{Linear, host};
use crate::rng::standard_normal;

/// A layer with weights from N(0, 1 / inputs) and biases 0.
pub(crate) fn dense(inputs: usize, outputs: usize, rng: &mut impl Rng, device: &Device) -> Linear {
    let std = 1.0 / (inputs as f64).sqrt();
    let weight = (0..inputs * outputs)
        .map(|_| (std * standard_normal(rng)) as f32)
        .collect();
    Linear {
        weight: Tensor::from_data(TensorData::new(weight, [1, inputs, outputs]), device),
        bias: Tensor::zeros([1, 1, outputs], device),
    }
}

/// `[1, rows, in] -> [1, rows, out]`, with ReLU if asked for.
pub(crate) fn forward(layer: &Linear, x: Tensor<3>, relu: bool) -> Tensor<3> {
    host::add_bias(x.matmul(layer.weight.clone()), &layer.bias, relu)
}

/// Gradients of the parameters, from the layer's input and the gradient in its sum.
pub(super) fn gradient(x: Tensor<3>, d_z: Tensor<3>) -> Linear {
    Linear {
        bias: d_z.clone().sum_dim(1),
        weight: x.swap_dims(1, 2).matmul(d_z),
    }
}

/// The same, and the gradient in the input.
pub(crate) fn backward(layer: &Linear, x: Tensor<3>, d_z: Tensor<3>) -> (Linear, Tensor<3>) {
    let d_x = d_z.clone().matmul(layer.weight.clone().swap_dims(1, 2));
    (gradient(x, d_z), d_x)
}

/// Weight and bias.
pub(crate) fn tensors(layer: &mut Linear) -> [&mut Tensor<3>; 2] {
    [&mut layer.weight, &mut layer.bias]
}
