//! Parameters of a perceptron, or anything of their shape, in the hands of one of the two engines.

use burn::tensor::Tensor;

use super::adam::AdamStep;
use super::plain::Plain;
use super::{Linear, fused};

/// The numbers, as the engine that computes with them holds them.
#[derive(Clone, Debug)]
pub(crate) enum Parameters {
    /// A tensor for each weight and each bias.
    Plain(Plain),
    /// One buffer.
    Fused(fused::Buffer),
}

/// Gradients of all parameters.
pub(crate) enum Gradients {
    /// A tensor for each weight and each bias.
    Plain(Plain),
    /// One buffer.
    Fused(fused::Gradients),
}

const ONE_ENGINE: &str = "what belongs to a network is on its engine";

impl Parameters {
    /// Weights and biases of each layer, whatever the engine: what is saved, exported and compared.
    pub(crate) fn layers(&self) -> Vec<Linear> {
        match self {
            Self::Plain(plain) => plain.layers.clone(),
            Self::Fused(fused) => fused.layers(),
        }
    }

    /// Puts others of the same shapes in their place.
    pub(crate) fn set_layers(&mut self, layers: Vec<Linear>) {
        match self {
            Self::Plain(plain) => plain.layers = layers,
            Self::Fused(fused) => *fused = fused::Buffer::from_layers(&layers),
        }
    }

    /// Shows every weight and bias to `visit`, by a name that begins with `name`, and keeps what it puts there: how a state is
    /// saved and restored.
    pub(crate) fn visit<E>(
        &mut self,
        name: &str,
        visit: &mut (impl FnMut(String, &mut Tensor<3>) -> Result<(), E> + ?Sized),
    ) -> Result<(), E> {
        let mut layers = self.layers();
        for (i, layer) in layers.iter_mut().enumerate() {
            visit(format!("{name}/{i}/weight"), &mut layer.weight)?;
            visit(format!("{name}/{i}/bias"), &mut layer.bias)?;
        }
        self.set_layers(layers);
        Ok(())
    }

    /// Zeros of the same shapes.
    pub(super) fn zeros_like(&self) -> Self {
        match self {
            Self::Plain(plain) => Self::Plain(plain.zeros_like()),
            Self::Fused(fused) => Self::Fused(fused.zeros_like()),
        }
    }

    /// One step of Adam with the moments `first` and `second`.
    pub(super) fn adam(
        &mut self,
        first: &mut Self,
        second: &mut Self,
        gradients: Gradients,
        step: AdamStep,
    ) {
        match (self, first, second, gradients) {
            (
                Self::Plain(own),
                Self::Plain(first),
                Self::Plain(second),
                Gradients::Plain(gradients),
            ) => own.adam(first, second, gradients, step),
            (
                Self::Fused(own),
                Self::Fused(first),
                Self::Fused(second),
                Gradients::Fused(gradients),
            ) => own.adam(first, second, &gradients, step),
            _ => unreachable!("{ONE_ENGINE}"),
        }
    }

    /// `velocity <- momentum velocity + gradient`, then `self <- self - rate velocity`.
    pub(super) fn descend(
        &mut self,
        velocity: &mut Self,
        gradients: Gradients,
        [momentum, rate]: [f32; 2],
    ) {
        match (self, velocity, gradients) {
            (Self::Plain(own), Self::Plain(velocity), Gradients::Plain(gradients)) => {
                own.descend(velocity, gradients, [momentum, rate]);
            }
            (Self::Fused(own), Self::Fused(velocity), Gradients::Fused(gradients)) => {
                own.descend(velocity, &gradients, [momentum, rate]);
            }
            _ => unreachable!("{ONE_ENGINE}"),
        }
    }

    /// Shrinks each weight matrix whose Frobenius norm is above `limit` to that norm.
    pub(super) fn project(&mut self, limit: f64) {
        match self {
            Self::Plain(plain) => plain.project(limit),
            Self::Fused(fused) => fused.project(limit),
        }
    }

    /// `self <- (1 - rate) self + rate source`.
    pub(super) fn polyak(&mut self, source: &Self, rate: f32) {
        match (self, source) {
            (Self::Plain(own), Self::Plain(source)) => own.polyak(source, rate),
            (Self::Fused(own), Self::Fused(source)) => own.polyak(source, rate),
            _ => unreachable!("{ONE_ENGINE}"),
        }
    }
}

#[cfg(test)]
impl Gradients {
    /// Weights and biases of each layer.
    pub(crate) fn layers(&self) -> Vec<Linear> {
        match self {
            Self::Plain(plain) => plain.layers.clone(),
            Self::Fused(fused) => fused.layers(),
        }
    }
}
