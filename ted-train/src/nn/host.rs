//! Fused passes over the buffers of tensors: what a tensor operation each would do slowly.
//!
//! burn's CPU devices hand out the buffer of a tensor that has one owner, and take it back, without a copy. One pass
//! then replaces several tensor operations, and gives the same bits on every CPU device.

use burn::tensor::{Tensor, TensorData};

/// Runs `body` on the values of several tensors, in place.
pub(super) fn in_place<const N: usize, const D: usize>(
    mut tensors: [&mut Tensor<D>; N],
    body: impl FnOnce([&mut [f32]; N]),
) {
    let device = tensors[0].device();
    let mut buffers: [TensorData; N] = tensors.each_mut().map(|tensor| {
        // The buffer comes without a copy only when the tensor left behind no longer shares it.
        std::mem::replace(*tensor, Tensor::empty([0; D], &device)).into_data()
    });
    body(
        buffers
            .each_mut()
            .map(|buffer| buffer.as_mut_slice().expect("parameters are f32")),
    );
    for (tensor, buffer) in tensors.into_iter().zip(buffers) {
        *tensor = Tensor::from_data(buffer, &device);
    }
}

/// Adds a bias `[member, 1, out]` to every row of `z [member, batch, out]`, and applies ReLU to the sum if asked to.
/// A sum that is not a number stays one, so that a learner that diverged is noticed.
pub(super) fn add_bias(z: &mut Tensor<3>, bias: &Tensor<3>, relu: bool) {
    let [_, batch, outputs] = z.dims();
    let bias = bias.clone().into_data();
    let bias = bias.as_slice::<f32>().expect("parameters are f32");
    in_place([z], |[z]| {
        for (z, bias) in z
            .chunks_exact_mut(batch * outputs)
            .zip(bias.chunks_exact(outputs))
        {
            for row in z.chunks_exact_mut(outputs) {
                for (z, bias) in row.iter_mut().zip(bias) {
                    let sum = *z + bias;
                    *z = if relu && sum < 0.0 { 0.0 } else { sum };
                }
            }
        }
    });
}

/// Sets to zero what ReLU did not let through: where its output `active` is zero.
pub(super) fn mask_inactive(gradient: &mut Tensor<3>, active: Tensor<3>) {
    let active = active.into_data();
    let active = active.as_slice::<f32>().expect("activations are f32");
    in_place([gradient], |[gradient]| {
        for (gradient, &active) in gradient.iter_mut().zip(active) {
            *gradient = if active > 0.0 { *gradient } else { 0.0 };
        }
    });
}
