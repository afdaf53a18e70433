//! Random features of an observation, which a linear model sees places with and not only directions: near is not far, and past is
//! neither.

use nalgebra::{DMatrix, DVector};
use rand::RngExt;

use crate::rng::{Seed, standard_normal};

/// `cos(W x + b)`: their products approximate a Gaussian kernel (Rahimi and Recht 2007).
#[derive(Clone, Debug)]
pub(super) struct Features {
    /// `[feature, channel]`.
    frequencies: DMatrix<f32>,
    phases: DVector<f32>,
}

impl Features {
    /// So many features of channels that have a deviation of 1, `moving` of which move: over `1 / frequency` of the usual distance
    /// of two observations the kernel falls.
    pub fn new(count: usize, frequency: f64, channels: usize, moving: usize, seed: Seed) -> Self {
        let mut rng = seed.rng();
        let scale = frequency / (moving.max(1) as f64).sqrt();
        let mut draw = |_, _| (scale * standard_normal(&mut rng)) as f32;
        let frequencies = DMatrix::from_fn(count, channels, &mut draw);
        let turn = std::f64::consts::TAU;
        let phases = DVector::from_fn(count, |_, _| (turn * rng.random::<f64>()) as f32);
        Self {
            frequencies,
            phases,
        }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.phases.len()
    }

    /// Those of observations, which are the columns of `[channel, step]`: `[feature, step]`.
    pub fn of(&self, channels: &DMatrix<f32>) -> DMatrix<f32> {
        let mut features = &self.frequencies * channels;
        for mut column in features.column_iter_mut() {
            column.zip_apply(&self.phases, |x, phase| *x = libm::cosf(*x + phase));
        }
        features
    }
}
