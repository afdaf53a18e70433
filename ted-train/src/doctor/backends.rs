//! Whether an engine computes what it should here: one small layer, on the instructions that this processor has.

use burn::tensor::{Tensor, TensorData};
use rand::RngExt;

use crate::nn::{Activation, Backend, ExportedLayer, ExportedMlp, Mlp};
use crate::rng::Seed;
use crate::tolerance::LAYER;

const SIZE: usize = 64;

/// The largest error of a layer against double precision, and whether it is as small as it should be.
pub(super) fn check(backend: Backend) -> Result<String, String> {
    backend.usable().map_err(|error| error.to_string())?;
    let mut rng = Seed::root(0).child("doctor").rng();
    let mut draw =
        |count: usize| -> Vec<f32> { (0..count).map(|_| rng.random_range(-1.0..1.0)).collect() };
    let (x, layer) = (
        draw(SIZE * SIZE),
        ExportedLayer {
            weight: draw(SIZE * SIZE),
            bias: draw(SIZE),
        },
    );
    let exact = |row: usize, output: usize| -> f64 {
        let (x, weight) = (&x[row * SIZE..], &layer.weight[output * SIZE..]);
        let products = x.iter().zip(weight).take(SIZE);
        let sum: f64 = products.map(|(&x, &w)| f64::from(x) * f64::from(w)).sum();
        sum + f64::from(layer.bias[output])
    };
    let network = ExportedMlp {
        layers: vec![layer.clone()],
        output: Activation::Linear,
    };
    let input = TensorData::new(x.clone(), [1, SIZE, SIZE]);
    let input = Tensor::from_data(input, &backend.device());
    let output: Vec<f32> = Mlp::from_exported(&network, backend)
        .forward(input)
        .into_data()
        .try_to_vec()
        .map_err(|error| format!("the output of a layer cannot be read: {error:?}"))?;
    let error = output
        .iter()
        .enumerate()
        .map(|(at, &value)| (f64::from(value) - exact(at / SIZE, at % SIZE)).abs())
        .fold(0.0, f64::max);
    if LAYER.allowed.holds(error, 1) {
        Ok(format!("works; largest error of a layer {error:.1e}"))
    } else {
        Err(format!(
            "a layer is wrong by {error:.1e}, and {} is allowed: do not train on this machine, and report its processor",
            LAYER.allowed
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_engine_computes_a_layer_as_it_should() {
        for backend in [Backend::Fused, Backend::Flex, Backend::Ndarray] {
            let found = check(backend);
            assert!(found.is_ok(), "{backend:?}: {found:?}");
        }
    }
}
