//! Adam (Kingma and Ba 2015), with optax's placement of epsilon, which IQL's original uses.

use burn::tensor::Tensor;
use serde::{Deserialize, Serialize};

use super::host::in_place;
use super::{Linear, Mlp};

/// Constants of the optimiser; the step size is an argument of each step because it may follow a schedule.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Adam {
    /// Decay of the first moment.
    pub beta1: f64,
    /// Decay of the second moment.
    pub beta2: f64,
    /// Added to the root of the second moment.
    pub epsilon: f64,
}

impl Default for Adam {
    fn default() -> Self {
        Self {
            beta1: 0.9,
            beta2: 0.999,
            epsilon: 1e-8,
        }
    }
}

/// First and second moments of a tensor.
#[derive(Clone, Debug)]
pub struct Moments<const D: usize> {
    pub(crate) first: Tensor<D>,
    pub(crate) second: Tensor<D>,
}

impl<const D: usize> Moments<D> {
    pub(crate) fn zeros_like(parameter: &Tensor<D>) -> Self {
        Self {
            first: parameter.zeros_like(),
            second: parameter.zeros_like(),
        }
    }
}

/// Moments of every parameter of a perceptron.
#[derive(Clone, Debug)]
pub struct AdamState {
    pub(crate) layers: Vec<(Moments<3>, Moments<3>)>,
}

impl AdamState {
    pub(crate) fn new(network: &Mlp) -> Self {
        let moments = |l: &Linear| (Moments::zeros_like(&l.weight), Moments::zeros_like(&l.bias));
        Self {
            layers: network.layers.iter().map(moments).collect(),
        }
    }
}

impl Adam {
    /// One step on every parameter of a network; `step` counts from 1.
    pub(crate) fn step(
        &self,
        network: &mut Mlp,
        state: &mut AdamState,
        gradients: Vec<Linear>,
        rate: f64,
        step: u64,
    ) {
        for ((layer, moments), gradient) in network
            .layers
            .iter_mut()
            .zip(&mut state.layers)
            .zip(gradients)
        {
            self.tensor(
                &mut layer.weight,
                &mut moments.0,
                gradient.weight,
                rate,
                step,
            );
            self.tensor(&mut layer.bias, &mut moments.1, gradient.bias, rate, step);
        }
    }

    /// One step on one parameter.
    pub(crate) fn tensor<const D: usize>(
        &self,
        parameter: &mut Tensor<D>,
        moments: &mut Moments<D>,
        gradient: Tensor<D>,
        rate: f64,
        step: u64,
    ) {
        let step = i32::try_from(step).unwrap_or(i32::MAX);
        let correct1 = 1.0 - self.beta1.powi(step);
        let correct2 = 1.0 - self.beta2.powi(step);
        let (beta1, beta2) = (self.beta1 as f32, self.beta2 as f32);
        let (fresh1, fresh2) = ((1.0 - self.beta1) as f32, (1.0 - self.beta2) as f32);
        let (rate, unbias2) = ((rate / correct1) as f32, (1.0 / correct2) as f32);
        let epsilon = self.epsilon as f32;
        let gradient = gradient.into_data();
        let gradient = gradient.as_slice::<f32>().expect("gradients are f32");
        in_place(
            [parameter, &mut moments.first, &mut moments.second],
            |[parameters, firsts, seconds]| {
                let moments = firsts.iter_mut().zip(seconds);
                for ((p, (m, v)), g) in parameters.iter_mut().zip(moments).zip(gradient) {
                    *m = beta1 * *m + fresh1 * g;
                    *v = beta2 * *v + fresh2 * g * g;
                    *p -= rate * *m / ((*v * unbias2).sqrt() + epsilon);
                }
            },
        );
    }
}
