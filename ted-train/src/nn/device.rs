//! Passes over tensors by tensor operations, for devices whose memory the host does not share. The order of the operations is
//! that of [`super::host`].

use burn::tensor::Tensor;

use super::adam::AdamStep;

pub(super) fn add_bias(z: Tensor<3>, bias: &Tensor<3>, relu: bool) -> Tensor<3> {
    let sum = z + bias.clone();
    if relu {
        let inactive = sum.clone().lower_elem(0.0);
        sum.mask_fill(inactive, 0.0)
    } else {
        sum
    }
}

pub(super) fn mask_inactive(gradient: Tensor<3>, active: Tensor<3>) -> Tensor<3> {
    // Not "lower or equal": that would let through what is not a number.
    gradient.mask_fill(active.greater_elem(0.0).bool_not(), 0.0)
}

pub(super) fn adam<const D: usize>(
    step: AdamStep,
    [parameter, first, second]: [&mut Tensor<D>; 3],
    gradient: Tensor<D>,
) {
    let AdamStep {
        beta,
        fresh,
        rate,
        unbias,
        epsilon,
    } = step;
    let g = gradient;
    let m = first.clone().mul_scalar(beta[0]) + g.clone().mul_scalar(fresh[0]);
    let v = second.clone().mul_scalar(beta[1]) + g.clone().mul_scalar(fresh[1]) * g;
    let root = v.clone().mul_scalar(unbias).sqrt().add_scalar(epsilon);
    *parameter = parameter.clone() - m.clone().mul_scalar(rate) / root;
    (*first, *second) = (m, v);
}

pub(super) fn polyak(old: &mut Tensor<3>, new: &Tensor<3>, rate: f32) {
    *old = old.clone().mul_scalar(1.0 - rate) + new.clone().mul_scalar(rate);
}
