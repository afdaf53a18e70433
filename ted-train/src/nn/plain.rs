//! The plain engine: a perceptron as tensor operations. It runs on every burn device and is what the fast engine is tested
//! against.

use burn::tensor::Tensor;

use super::adam::AdamStep;
use super::passes::Passes;
use super::{Activation, Linear};

/// Parameters of a perceptron, or anything of their shape: a tensor for each weight and each bias.
#[derive(Clone, Debug)]
pub(crate) struct Plain {
    pub(super) layers: Vec<Linear>,
    passes: Passes,
}

/// What the backward pass needs of a forward pass: the input of each layer and the network's output.
pub(crate) struct Tape {
    inputs: Vec<Tensor<3>>,
    output: Tensor<3>,
}

impl Plain {
    /// From weights and biases of each layer.
    pub(super) fn new(layers: Vec<Linear>, passes: Passes) -> Self {
        Self { layers, passes }
    }

    /// Zeros of the same shape.
    pub(super) fn zeros_like(&self) -> Self {
        let zeros = |l: &Linear| Linear {
            weight: l.weight.zeros_like(),
            bias: l.bias.zeros_like(),
        };
        Self::new(self.layers.iter().map(zeros).collect(), self.passes)
    }

    /// `[member, batch, in] -> [member, batch, out]`, showing the input of each layer to `seen`.
    pub(super) fn run(
        &self,
        x: Tensor<3>,
        output: Activation,
        mut seen: impl FnMut(&Tensor<3>),
    ) -> Tensor<3> {
        let last = self.layers.len() - 1;
        let mut h = x;
        for (i, layer) in self.layers.iter().enumerate() {
            seen(&h);
            let z = h.matmul(layer.weight.clone());
            let z = self.passes.add_bias(z, &layer.bias, i != last);
            h = match (i == last, output) {
                (false, _) | (true, Activation::Linear) => z,
                (true, Activation::Tanh) => z.tanh(),
            };
        }
        h
    }

    /// The same, keeping what [`Self::gradients`] needs.
    pub(super) fn forward_tape(&self, x: Tensor<3>, output: Activation) -> (Tensor<3>, Tape) {
        let mut inputs = Vec::with_capacity(self.layers.len());
        let output = self.run(x, output, |h| inputs.push(h.clone()));
        (output.clone(), Tape { inputs, output })
    }

    /// Gradients of a scalar loss in the parameters, from its gradient `[member, batch, out]` in the output.
    pub(super) fn gradients(&self, tape: Tape, output: Activation, d_output: Tensor<3>) -> Self {
        let mut delta = before_activation(tape.output, output, d_output);
        let mut layers = Vec::with_capacity(self.layers.len());
        for (i, (layer, input)) in self.layers.iter().zip(tape.inputs).enumerate().rev() {
            let bias = delta.clone().sum_dim(1);
            let weight = input.clone().swap_dims(1, 2).matmul(delta.clone());
            if i > 0 {
                // ReLU passes the gradient where its output is positive.
                let all = delta.matmul(layer.weight.clone().swap_dims(1, 2));
                delta = self.passes.mask_inactive(all, input);
            }
            layers.push(Linear { weight, bias });
        }
        layers.reverse();
        Self::new(layers, self.passes)
    }

    /// Gradient of a scalar loss in the input `[member, batch, in]`, from its gradient `[member, batch, out]` in the output.
    pub(super) fn input_gradient(
        &self,
        tape: Tape,
        output: Activation,
        d_output: Tensor<3>,
    ) -> Tensor<3> {
        let mut delta = before_activation(tape.output, output, d_output);
        for (i, (layer, input)) in self.layers.iter().zip(tape.inputs).enumerate().rev() {
            delta = delta.matmul(layer.weight.clone().swap_dims(1, 2));
            if i > 0 {
                delta = self.passes.mask_inactive(delta, input);
            }
        }
        delta
    }

    /// `velocity <- momentum velocity + gradient`, then `self <- self - rate velocity`.
    pub(super) fn descend(
        &mut self,
        velocity: &mut Self,
        gradients: Self,
        [momentum, rate]: [f32; 2],
    ) {
        let step = |own: &mut Tensor<3>, velocity: &mut Tensor<3>, gradient: Tensor<3>| {
            *velocity = velocity.clone().mul_scalar(momentum) + gradient;
            *own = own.clone() - velocity.clone().mul_scalar(rate);
        };
        let layers = self.layers.iter_mut().zip(&mut velocity.layers);
        for ((own, velocity), gradient) in layers.zip(gradients.layers) {
            step(&mut own.weight, &mut velocity.weight, gradient.weight);
            step(&mut own.bias, &mut velocity.bias, gradient.bias);
        }
    }

    /// Shrinks each weight matrix whose Frobenius norm is above `limit` to that norm.
    pub(super) fn project(&mut self, limit: f64) {
        for layer in &mut self.layers {
            let weight = layer.weight.clone();
            let norm = (weight.clone() * weight.clone()).sum_dims(&[1, 2]).sqrt();
            layer.weight = weight * norm.recip().mul_scalar(limit).clamp_max(1.0);
        }
    }

    /// One step of Adam with the moments `first` and `second`.
    pub(super) fn adam(
        &mut self,
        first: &mut Self,
        second: &mut Self,
        gradients: Self,
        step: AdamStep,
    ) {
        let moments = first.layers.iter_mut().zip(&mut second.layers);
        let layers = self.layers.iter_mut().zip(moments).zip(gradients.layers);
        for ((layer, (first, second)), gradient) in layers {
            let weights = [&mut layer.weight, &mut first.weight, &mut second.weight];
            self.passes.adam(step, weights, gradient.weight);
            let biases = [&mut layer.bias, &mut first.bias, &mut second.bias];
            self.passes.adam(step, biases, gradient.bias);
        }
    }

    /// `self <- (1 - rate) self + rate source`.
    pub(super) fn polyak(&mut self, source: &Self, rate: f32) {
        for (old, new) in self.layers.iter_mut().zip(&source.layers) {
            self.passes.polyak(&mut old.weight, &new.weight, rate);
            self.passes.polyak(&mut old.bias, &new.bias, rate);
        }
    }
}

/// The gradient before the last activation, from that in its output.
fn before_activation(y: Tensor<3>, output: Activation, d_output: Tensor<3>) -> Tensor<3> {
    match output {
        Activation::Linear => d_output,
        Activation::Tanh => d_output * (y.clone() * y).neg().add_scalar(1.0),
    }
}
