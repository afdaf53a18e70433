//! Stochastic gradient descent with momentum, as AWR's original has it: what is added up is the gradient, not the step.

use burn::tensor::Tensor;

use super::Mlp;
use super::parameters::{Gradients, Parameters};

/// The decaying sum of a network's gradients.
#[derive(Clone, Debug)]
pub struct Velocity(Parameters);

impl Velocity {
    /// Of a network that has not moved yet.
    pub(crate) fn zero(network: &Mlp) -> Self {
        Self(network.parameters.zeros_like())
    }

    /// `velocity <- momentum velocity + gradient`, then `parameter <- parameter - rate velocity`.
    pub(crate) fn step(
        &mut self,
        network: &mut Mlp,
        gradients: Gradients,
        momentum: f64,
        rate: f64,
    ) {
        let constants = [momentum as f32, rate as f32];
        network
            .parameters
            .descend(&mut self.0, gradients, constants);
    }

    /// Shows every number to `visit`, by a name that begins with `name`, and keeps what it puts there.
    pub(crate) fn visit<E>(
        &mut self,
        name: &str,
        visit: &mut (impl FnMut(String, &mut Tensor<3>) -> Result<(), E> + ?Sized),
    ) -> Result<(), E> {
        self.0.visit(name, visit)
    }
}
