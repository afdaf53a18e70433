//! Fused passes over the buffers of tensors: what a tensor operation each, as in [`super::device`], would do slowly on a
//! processor.
//!
//! burn's CPU devices hand out the buffer of a tensor that has one owner, and take it back, without a copy. One pass
//! then replaces several tensor operations, and gives the same bits on every CPU device.

use burn::tensor::{Tensor, TensorData};

use super::adam::AdamStep;

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

pub(super) fn add_bias(mut z: Tensor<3>, bias: &Tensor<3>, relu: bool) -> Tensor<3> {
    let [_, batch, outputs] = z.dims();
    let bias = bias.clone().into_data();
    let bias = bias.as_slice::<f32>().expect("parameters are f32");
    in_place([&mut z], |[z]| {
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
    z
}

pub(crate) fn mask_inactive(mut gradient: Tensor<3>, active: Tensor<3>) -> Tensor<3> {
    let active = active.into_data();
    let active = active.as_slice::<f32>().expect("activations are f32");
    in_place([&mut gradient], |[gradient]| {
        for (gradient, &active) in gradient.iter_mut().zip(active) {
            *gradient = if active > 0.0 { *gradient } else { 0.0 };
        }
    });
    gradient
}

pub(super) fn adam<const D: usize>(
    step: AdamStep,
    parameter_and_moments: [&mut Tensor<D>; 3],
    gradient: Tensor<D>,
) {
    let gradient = gradient.into_data();
    let gradient = gradient.as_slice::<f32>().expect("gradients are f32");
    in_place(parameter_and_moments, |[parameters, firsts, seconds]| {
        let moments = firsts.iter_mut().zip(seconds);
        for ((p, (m, v)), g) in parameters.iter_mut().zip(moments).zip(gradient) {
            step.apply(p, m, v, *g);
        }
    });
}

pub(super) fn polyak(old: &mut Tensor<3>, new: &Tensor<3>, rate: f32) {
    let new = new.clone().into_data();
    let new = new.as_slice::<f32>().expect("parameters are f32");
    in_place([old], |[old]| {
        for (old, new) in old.iter_mut().zip(new) {
            *old = (1.0 - rate) * *old + rate * new;
        }
    });
}
