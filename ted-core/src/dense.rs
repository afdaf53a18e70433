//! One dense layer that borrows its weights.

use crate::activation::Activation;
use crate::error::{Part, ShapeError};
use crate::kernel;
use crate::limits::MAX_WIDTH;

/// A dense layer: `weights` row-major `[outputs][inputs]`, one bias per output. Its existence proves that they fit.
#[derive(Clone, Copy, Debug)]
pub struct Dense<'a> {
    inputs: usize,
    weights: &'a [f32],
    bias: &'a [f32],
}

impl<'a> Dense<'a> {
    /// Checks the sizes and borrows the parameters.
    ///
    /// # Errors
    /// When a side is empty or wider than [`MAX_WIDTH`], or a slice has another length than the sides ask for.
    pub fn new(
        inputs: usize,
        outputs: usize,
        weights: &'a [f32],
        bias: &'a [f32],
    ) -> Result<Self, ShapeError> {
        ShapeError::within(Part::Inputs, MAX_WIDTH, inputs)?;
        ShapeError::within(Part::Outputs, MAX_WIDTH, outputs)?;
        ShapeError::same(Part::Weights, inputs * outputs, weights.len())?;
        ShapeError::same(Part::Bias, outputs, bias.len())?;
        Ok(Self {
            inputs,
            weights,
            bias,
        })
    }

    /// Number of inputs.
    #[must_use]
    pub fn inputs(&self) -> usize {
        self.inputs
    }

    /// Number of outputs.
    #[must_use]
    pub fn outputs(&self) -> usize {
        self.bias.len()
    }

    /// The weights, row-major `[outputs][inputs]`.
    #[must_use]
    pub fn weights(&self) -> &'a [f32] {
        self.weights
    }

    /// The biases.
    #[must_use]
    pub fn bias(&self) -> &'a [f32] {
        self.bias
    }

    /// Applies the layer and then the activation to every output.
    pub(crate) fn apply(
        &self,
        x: &[f32],
        out: &mut [f32],
        activation: Activation,
    ) -> Result<(), ShapeError> {
        ShapeError::same(Part::Input, self.inputs, x.len())?;
        ShapeError::same(Part::Output, self.outputs(), out.len())?;
        kernel::dense(self.weights, self.bias, x, out);
        activation.apply(out);
        Ok(())
    }
}
