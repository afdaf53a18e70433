//! Whether a burn backend computes what it should here: one small matrix product.

use burn::tensor::{Tensor, TensorData};
use rand::RngExt;

use crate::nn::Backend;
use crate::rng::Seed;
use crate::tolerance::MATMUL;

const SIZE: usize = 64;

/// The largest error of a matrix product against double precision, and whether it is as small as it should be.
pub(super) fn check(backend: Backend) -> Result<String, String> {
    backend.usable().map_err(|error| error.to_string())?;
    let mut rng = Seed::root(0).child("doctor").rng();
    let mut draw = || -> Vec<f32> {
        (0..SIZE * SIZE)
            .map(|_| rng.random_range(-1.0..1.0))
            .collect()
    };
    let (left, right) = (draw(), draw());
    let device = backend.device();
    let tensor = |values: &[f32]| -> Tensor<2> {
        Tensor::from_data(TensorData::new(values.to_vec(), [SIZE, SIZE]), &device)
    };
    let product: Vec<f32> = tensor(&left)
        .matmul(tensor(&right))
        .into_data()
        .try_to_vec()
        .map_err(|error| format!("the product of two matrices cannot be read: {error:?}"))?;
    let exact = |row: usize, column: usize| -> f64 {
        (0..SIZE)
            .map(|i| f64::from(left[row * SIZE + i]) * f64::from(right[i * SIZE + column]))
            .sum()
    };
    let error = product
        .iter()
        .enumerate()
        .map(|(at, &value)| (f64::from(value) - exact(at / SIZE, at % SIZE)).abs())
        .fold(0.0, f64::max);
    if MATMUL.allowed.holds(error, 1) {
        Ok(format!("works; largest error of a product {error:.1e}"))
    } else {
        Err(format!(
            "a matrix product is wrong by {error:.1e}, and {} is allowed: do not train on this machine, and report its processor",
            MATMUL.allowed
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_backends_multiply_as_they_should() {
        for backend in [Backend::Flex, Backend::Ndarray] {
            let found = check(backend);
            assert!(found.is_ok(), "{backend:?}: {found:?}");
        }
    }
}
