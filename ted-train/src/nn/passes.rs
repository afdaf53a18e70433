//! The passes over whole tensors that the plain engine makes besides products: in the buffers of a processor, or as tensor
//! operations where the host does not share the memory. Both compute the same, to the bit on one machine.

use burn::tensor::Tensor;

use super::adam::AdamStep;
use super::{Backend, device, host};

/// Where they are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Passes {
    /// In the buffers themselves.
    Host,
    /// By tensor operations: nothing leaves the device.
    Device,
}

impl Passes {
    /// Where a backend makes them.
    pub(super) fn of(backend: Backend) -> Self {
        match backend {
            Backend::Fused | Backend::Flex | Backend::Ndarray => Self::Host,
            Backend::Cuda => Self::Device,
        }
    }

    /// Adds a bias `[member, 1, out]` to every row of `z [member, batch, out]`, and applies ReLU to the sum if asked to.
    /// A sum that is not a number stays one, so that a learner that diverged is noticed.
    pub(super) fn add_bias(self, z: Tensor<3>, bias: &Tensor<3>, relu: bool) -> Tensor<3> {
        match self {
            Self::Host => host::add_bias(z, bias, relu),
            Self::Device => device::add_bias(z, bias, relu),
        }
    }

    /// Sets to zero what ReLU did not let through: where its output `active` is zero.
    pub(super) fn mask_inactive(self, gradient: Tensor<3>, active: Tensor<3>) -> Tensor<3> {
        match self {
            Self::Host => host::mask_inactive(gradient, active),
            Self::Device => device::mask_inactive(gradient, active),
        }
    }

    /// One step of Adam on a parameter and its two moments.
    pub(super) fn adam<const D: usize>(
        self,
        step: AdamStep,
        parameter_and_moments: [&mut Tensor<D>; 3],
        gradient: Tensor<D>,
    ) {
        match self {
            Self::Host => host::adam(step, parameter_and_moments, gradient),
            Self::Device => device::adam(step, parameter_and_moments, gradient),
        }
    }

    /// `old <- (1 - rate) old + rate new`.
    pub(super) fn polyak(self, old: &mut Tensor<3>, new: &Tensor<3>, rate: f32) {
        match self {
            Self::Host => host::polyak(old, new, rate),
            Self::Device => device::polyak(old, new, rate),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nn::Adam;
    use crate::nn::fixtures::{bits, numbers, tensor, values};

    const SHAPE: [usize; 3] = [2, 5, 3];
    const BOTH: [Passes; 2] = [Passes::Host, Passes::Device];

    /// Numbers with zeros of both signs, what is not a number, and what is none any more, among them.
    fn given(name: &str) -> Tensor<3> {
        let mut given = numbers(30, name);
        given[..4].copy_from_slice(&[0.0, -0.0, f32::NAN, f32::INFINITY]);
        tensor(&given, SHAPE, Backend::Flex)
    }

    fn same(what: &str, of: impl Fn(Passes) -> Vec<Tensor<3>>) {
        let [host, device] = BOTH.map(|passes| -> Vec<_> {
            let tensors = of(passes).into_iter();
            tensors.map(|tensor| bits(&values(tensor))).collect()
        });
        assert_eq!(host, device, "{what}");
    }

    #[test]
    fn tensor_operations_and_loops_over_buffers_have_the_same_bits() {
        let bias = tensor(&numbers(6, "bias"), [2, 1, 3], Backend::Flex);
        for relu in [false, true] {
            same("bias", |p| vec![p.add_bias(given("z"), &bias, relu)]);
        }
        same("mask", |p| vec![p.mask_inactive(given("d"), given("z"))]);
        same("averaging", |p| {
            let mut old = given("old");
            p.polyak(&mut old, &given("new"), 0.005);
            vec![old]
        });
        same("Adam", |p| {
            let [mut parameter, mut first, mut second] = ["p", "m", "v"].map(given);
            second = second.abs();
            for at in 1..=3 {
                let step = Adam::default().constants(3e-4, at);
                let gradient = given(&format!("g/{at}"));
                p.adam(step, [&mut parameter, &mut first, &mut second], gradient);
            }
            vec![parameter, first, second]
        });
    }
}
