//! The one loss, with its gradient in the policy's output.

use burn::tensor::Tensor;

/// `mean (pi(s) - a)^2` over batch and coordinates, `[lane, 1, 1]`, and its gradient in `pi(s)`, both `[lane, batch, action]`.
pub(super) fn imitation_loss(policy: Tensor<3>, actions: Tensor<3>) -> (Tensor<3>, Tensor<3>) {
    let [_, batch, width] = policy.dims();
    let error = policy - actions;
    let loss = (error.clone() * error.clone()).mean_dims(&[1, 2]);
    (loss, error.mul_scalar(2.0 / (batch * width) as f64))
}
