//! Initial weights, drawn on the host from a named stream so that every backend starts from the same bits.

use nalgebra::DMatrix;
use rand::{Rng, RngExt};
use serde::{Deserialize, Serialize};

use crate::rng::standard_normal;

/// How the weights and biases of a layer are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Initialiser {
    /// Orthogonal with gain sqrt(2), biases zero (ikostrikov/implicit_q_learning `common.py`).
    Orthogonal,
    /// Uniform in +-1/sqrt(inputs), weights and biases (PyTorch's default, used by OPRL's reward networks).
    UniformFanIn,
    /// Uniform in +-sqrt(6/(inputs + outputs)), biases zero (Glorot and Bengio 2010; AWR's original).
    Xavier,
}

impl Initialiser {
    /// Weights `[inputs, outputs]` in row-major order and biases `[outputs]`.
    pub fn draw(self, inputs: usize, outputs: usize, rng: &mut impl Rng) -> (Vec<f32>, Vec<f32>) {
        match self {
            Self::Orthogonal => (
                orthogonal(inputs, outputs, std::f64::consts::SQRT_2, rng),
                vec![0.0; outputs],
            ),
            Self::UniformFanIn => {
                let bound = 1.0 / (inputs as f32).sqrt();
                let mut draw = |n| (0..n).map(|_| rng.random_range(-bound..bound)).collect();
                (draw(inputs * outputs), draw(outputs))
            }
            Self::Xavier => {
                let bound = Self::xavier_bound(inputs, outputs) as f32;
                let draw = |_| rng.random_range(-bound..bound);
                let weights = (0..inputs * outputs).map(draw).collect();
                (weights, vec![0.0; outputs])
            }
        }
    }

    /// Largest weight that [`Self::Xavier`] draws.
    #[must_use]
    pub fn xavier_bound(inputs: usize, outputs: usize) -> f64 {
        (6.0 / (inputs + outputs) as f64).sqrt()
    }
}

/// A `[rows, columns]` matrix, row-major, whose shorter side is orthonormal, times `gain`.
///
/// The QR decomposition of a Gaussian matrix with a diagonal of R that is not negative, which makes Q uniform over
/// orthogonal matrices (Saxe et al. 2014, as in `jax.nn.initializers.orthogonal`); nalgebra's `q` has the signs in it.
pub fn orthogonal(rows: usize, columns: usize, gain: f64, rng: &mut impl Rng) -> Vec<f32> {
    let (tall, wide) = (rows.max(columns), rows.min(columns));
    let gaussian = DMatrix::from_fn(tall, wide, |_, _| standard_normal(rng));
    let q = gaussian.qr().q();
    let entry = |i: usize, j: usize| gain * q[(i, j)];
    let mut weights = Vec::with_capacity(rows * columns);
    for i in 0..rows {
        for j in 0..columns {
            weights.push(if rows >= columns {
                entry(i, j)
            } else {
                entry(j, i)
            } as f32);
        }
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Seed;

    #[test]
    fn orthogonal_weights_have_orthogonal_shorter_side_with_the_gain() {
        for (rows, columns) in [(39, 256), (256, 256), (256, 4), (256, 1)] {
            let w = orthogonal(rows, columns, 2f64.sqrt(), &mut Seed::root(1).rng());
            let m = DMatrix::from_row_slice(rows, columns, &w).map(f64::from);
            let gram = if rows >= columns {
                m.transpose() * &m
            } else {
                &m * m.transpose()
            };
            let error =
                (gram - DMatrix::identity(rows.min(columns), rows.min(columns)) * 2.0).amax();
            assert!(error < 1e-5, "{rows}x{columns}: {error}");
        }
    }
}
