//! burn without std, on its flex backend: three linear layers as tensors. It allocates while it computes.

use alloc::vec::Vec;
use core::hint::black_box;

use burn::tensor::activation::relu;
use burn::tensor::{Device, Tensor, TensorData};

use crate::network::Layer;
use crate::section;

/// The action in f32.
#[inline(never)]
pub fn f32(layers: &[Layer], x: &[f32]) -> Vec<f32> {
    let device = Device::flex();
    let [first, second, last] = layers else {
        unreachable!()
    };
    let first = Linear::new(first, &device);
    let second = Linear::new(second, &device);
    let last = Linear::new(last, &device);
    let (first, second, last) = black_box((&first, &second, &last));
    section::rest();
    let x = Tensor::<2>::from_data(TensorData::new(x.to_vec(), [1, x.len()]), &device);
    let y = relu(first.forward(x));
    let y = relu(second.forward(y));
    let action = last.forward(y).tanh().into_data();
    section::burn_f32();
    action.iter::<f32>().collect()
}

struct Linear {
    weights: Tensor<2>,
    bias: Tensor<2>,
}

impl Linear {
    /// burn multiplies a row by a matrix of `[inputs][outputs]`.
    fn new(layer: &Layer, device: &Device) -> Self {
        let (inputs, outputs) = (layer.inputs, layer.bias.len());
        let weights =
            (0..inputs * outputs).map(|k| layer.weights[k % outputs * inputs + k / outputs]);
        let weights = TensorData::new(weights.collect::<Vec<f32>>(), [inputs, outputs]);
        let bias = TensorData::new(layer.bias.clone(), [1, outputs]);
        Self {
            weights: Tensor::from_data(weights, device),
            bias: Tensor::from_data(bias, device),
        }
    }

    fn forward(&self, x: Tensor<2>) -> Tensor<2> {
        x.matmul(self.weights.clone()) + self.bias.clone()
    }
}
