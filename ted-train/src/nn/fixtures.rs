//! What tests of tensor code share: all backends, tensors from plain numbers and back, comparisons that say where.

use burn::tensor::{Tensor, TensorData};
use rand::RngExt;

use super::Backend;
use crate::rng::Seed;

/// Every test of tensor code runs on all. Without the feature `cuda` the last one is what a GPU would be given to compute,
/// computed by the processor.
pub(crate) const BACKENDS: [Backend; 4] = [
    Backend::Fused,
    Backend::Flex,
    Backend::Ndarray,
    Backend::Cuda,
];

/// A tensor of these numbers, in row-major order.
pub(crate) fn tensor(values: &[f32], shape: [usize; 3], backend: Backend) -> Tensor<3> {
    Tensor::from_data(TensorData::new(values.to_vec(), shape), &backend.device())
}

/// The numbers of a tensor, in row-major order.
pub(crate) fn values(tensor: Tensor<3>) -> Vec<f32> {
    tensor.into_data().try_to_vec().unwrap()
}

/// Numbers in [-1, 1) from a stream of their own.
pub(crate) fn numbers(count: usize, stream: &str) -> Vec<f32> {
    let mut rng = Seed::root(0).child(stream).rng();
    (0..count).map(|_| rng.random_range(-1.0..1.0)).collect()
}

/// The same numbers in double precision.
pub(crate) fn wide(values: &[f32]) -> Vec<f64> {
    values.iter().map(|&v| f64::from(v)).collect()
}

/// The bits, for comparisons that tell 0.0 from -0.0.
pub(crate) fn bits(values: &[f32]) -> Vec<u32> {
    values.iter().map(|v| v.to_bits()).collect()
}

/// Fails with the place and the two numbers where they are farther apart than `tolerance`, which scales with numbers
/// above one.
pub(crate) fn assert_close(actual: &[f32], expected: &[f64], tolerance: f64, what: &str) {
    assert_eq!(actual.len(), expected.len(), "{what}: lengths");
    for (i, (&a, &e)) in actual.iter().zip(expected).enumerate() {
        let error = (f64::from(a) - e).abs() / e.abs().max(1.0);
        assert!(
            error <= tolerance,
            "{what}[{i}] is {a}, expected {e}, off by {error:e}"
        );
    }
}
