//! Loops over the buffers of tensors, for updates that touch every parameter.
//!
//! burn's CPU devices hand out the buffer of a tensor that has one owner, and take it back, without a copy. One fused
//! pass over the parameters then replaces a dozen tensor operations, and gives the same bits on every CPU device.

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
