//! Adam (Kingma and Ba 2015), with optax's placement of epsilon, which IQL's original uses.

use burn::tensor::Tensor;
use serde::{Deserialize, Serialize};

use super::parameters::{Gradients, Parameters};
use super::{Mlp, device};

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
    pub(crate) first: Parameters,
    pub(crate) second: Parameters,
}

impl AdamState {
    pub(crate) fn new(network: &Mlp) -> Self {
        Self {
            first: network.parameters.zeros_like(),
            second: network.parameters.zeros_like(),
        }
    }
}

impl AdamState {
    /// Shows every moment to `visit`, by a name that begins with `name`, and keeps what it puts there.
    pub(crate) fn visit<E>(
        &mut self,
        name: &str,
        visit: &mut (impl FnMut(String, &mut Tensor<3>) -> Result<(), E> + ?Sized),
    ) -> Result<(), E> {
        self.first.visit(&format!("{name}/first"), visit)?;
        self.second.visit(&format!("{name}/second"), visit)
    }
}

/// The constants of one step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AdamStep {
    /// Shares of the old moments.
    pub(super) beta: [f32; 2],
    /// Shares of the gradient in the new ones.
    pub(super) fresh: [f32; 2],
    /// Step size, corrected for the first moment's start at zero.
    pub(super) rate: f32,
    /// Correction of the second moment.
    pub(super) unbias: f32,
    pub(super) epsilon: f32,
}

impl AdamStep {
    /// Moves one number and its moments.
    #[inline(always)]
    pub(super) fn apply(&self, p: &mut f32, m: &mut f32, v: &mut f32, g: f32) {
        *m = self.beta[0] * *m + self.fresh[0] * g;
        *v = self.beta[1] * *v + self.fresh[1] * g * g;
        *p -= self.rate * *m / ((*v * self.unbias).sqrt() + self.epsilon);
    }
}

impl Adam {
    /// One step on every parameter of a network; `step` counts from 1.
    pub(crate) fn step(
        &self,
        network: &mut Mlp,
        state: &mut AdamState,
        gradients: Gradients,
        rate: f64,
        step: u64,
    ) {
        let (first, second) = (&mut state.first, &mut state.second);
        let step = self.constants(rate, step);
        network.parameters.adam(first, second, gradients, step);
    }

    /// One step on one tensor, which is small and belongs to no network.
    pub(crate) fn tensor<const D: usize>(
        &self,
        parameter: &mut Tensor<D>,
        moments: &mut Moments<D>,
        gradient: Tensor<D>,
        rate: f64,
        step: u64,
    ) {
        let step = self.constants(rate, step);
        let all = [parameter, &mut moments.first, &mut moments.second];
        device::adam(step, all, gradient);
    }

    pub(super) fn constants(&self, rate: f64, step: u64) -> AdamStep {
        let step = i32::try_from(step).unwrap_or(i32::MAX);
        let correct = [self.beta1, self.beta2].map(|beta| 1.0 - beta.powi(step));
        AdamStep {
            beta: [self.beta1, self.beta2].map(|beta| beta as f32),
            fresh: [self.beta1, self.beta2].map(|beta| (1.0 - beta) as f32),
            rate: (rate / correct[0]) as f32,
            unbias: (1.0 / correct[1]) as f32,
            epsilon: self.epsilon as f32,
        }
    }
}
