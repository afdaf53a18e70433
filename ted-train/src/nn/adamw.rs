//! AdamW (Loshchilov and Hutter 2019): Adam, and a decay of the weights that does not go through its moments.

use burn::tensor::Tensor;
use serde::{Deserialize, Serialize};

use super::adam::{Adam, Moments};
use super::host::{self, in_place};
use crate::checkpoint::{Checkpoint, ForeignCheckpoint};

/// Constants of the optimiser; the step size is an argument of each step because it follows a schedule.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct AdamW {
    /// Decays of the moments, and the number added to the root.
    pub adam: Adam,
    /// Share of every parameter that a step of size 1 would take away.
    pub weight_decay: f64,
}

impl Default for AdamW {
    /// optax's constants.
    fn default() -> Self {
        Self {
            adam: Adam::default(),
            weight_decay: 1e-4,
        }
    }
}

/// The moments of a network's parameters, in the order of its list of tensors.
#[derive(Clone, Debug)]
pub(crate) struct AdamWState {
    moments: Vec<Moments<3>>,
}

impl AdamWState {
    /// Before the first step.
    pub(crate) fn new(parameters: Vec<&mut Tensor<3>>) -> Self {
        let zeros = |parameter: &mut Tensor<3>| Moments::zeros_like(parameter);
        Self {
            moments: parameters.into_iter().map(zeros).collect(),
        }
    }

    /// Adds the parameters and their moments to a checkpoint, under the network's name.
    pub(crate) fn save(
        &self,
        name: &str,
        parameters: Vec<&mut Tensor<3>>,
        checkpoint: &mut Checkpoint,
    ) {
        for (i, (parameter, moments)) in parameters.into_iter().zip(&self.moments).enumerate() {
            checkpoint.push(format!("{name}/{i}"), parameter, 0, 1);
            checkpoint.push(format!("adam/{name}/{i}/first"), &moments.first, 0, 1);
            checkpoint.push(format!("adam/{name}/{i}/second"), &moments.second, 0, 1);
        }
    }

    /// Puts saved parameters and moments in the place of these.
    ///
    /// # Errors
    /// When the checkpoint lacks a tensor or has another shape; neither must be used then.
    pub(crate) fn restore(
        &mut self,
        name: &str,
        parameters: Vec<&mut Tensor<3>>,
        checkpoint: &Checkpoint,
    ) -> Result<(), ForeignCheckpoint> {
        let parameters = parameters.into_iter().zip(&mut self.moments);
        for (i, (parameter, moments)) in parameters.enumerate() {
            let device = parameter.device();
            let fetch = |name: String| Checkpoint::fetch(&[checkpoint], &name, parameter, &device);
            let first = fetch(format!("adam/{name}/{i}/first"))?;
            let second = fetch(format!("adam/{name}/{i}/second"))?;
            *parameter = fetch(format!("{name}/{i}"))?;
            *moments = Moments { first, second };
        }
        Ok(())
    }
}

impl AdamW {
    /// One step on every parameter; gradients are in the order of the parameters and are taken away, and `step` counts
    /// from 1.
    pub(crate) fn step(
        &self,
        parameters: Vec<&mut Tensor<3>>,
        state: &mut AdamWState,
        gradients: Vec<&mut Tensor<3>>,
        rate: f64,
        step: u64,
    ) {
        let constants = self.adam.constants(rate, step);
        let kept = (1.0 - rate * self.weight_decay) as f32;
        let parameters = parameters.into_iter().zip(&mut state.moments);
        for ((parameter, moments), gradient) in parameters.zip(gradients) {
            in_place([parameter], |[values]| {
                values.iter_mut().for_each(|value| *value *= kept);
            });
            let nothing = Tensor::empty([0; 3], &gradient.device());
            let gradient = std::mem::replace(gradient, nothing);
            let Moments { first, second } = moments;
            host::adam(constants, [parameter, first, second], gradient);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nn::fixtures::{BACKENDS, assert_close, tensor, values};

    #[test]
    fn two_steps_are_what_a_hand_computes() {
        let adamw = AdamW {
            adam: Adam {
                beta1: 0.5,
                beta2: 0.75,
                epsilon: 0.0,
            },
            weight_decay: 0.25,
        };
        for backend in BACKENDS {
            let mut parameter = tensor(&[2.0], [1, 1, 1], backend);
            let mut state = AdamWState::new(vec![&mut parameter]);
            let mut step = |gradient: f32, step| {
                let mut gradient = tensor(&[gradient], [1, 1, 1], backend);
                adamw.step(
                    vec![&mut parameter],
                    &mut state,
                    vec![&mut gradient],
                    0.1,
                    step,
                );
                values(parameter.clone())[0]
            };
            // 2 - 0.1 (0.25 * 2 + 1): the first step of Adam is the sign of the gradient.
            assert_close(&[step(3.0, 1)], &[1.85], 1e-6, "first");
            // Moments 0.5 * 1.5 - 0.5 and 0.75 * 2.25 + 0.25, corrected by 1 - 0.25 and 1 - 0.5625.
            let adam = (0.25 / 0.75) / (1.9375f64 / 0.4375).sqrt();
            let expected = 1.85 - 0.1 * (0.25 * 1.85 + adam);
            assert_close(&[step(-1.0, 2)], &[expected], 1e-6, "second");
        }
    }
}
