//! The two losses, each with its gradient in the output of the network it trains.
//!
//! Shapes: `[lane, batch, 1]` for values and weights, `[lane, batch, action]` for actions. A loss is `[lane, 1, 1]`.

use burn::tensor::Tensor;

/// `1/2 mean (v - target)^2`, and its gradient in `v`.
pub(super) fn value_loss(v: Tensor<3>, target: Tensor<3>) -> (Tensor<3>, Tensor<3>) {
    let batch = v.dims()[1] as f64;
    let error = v - target;
    let loss = (error.clone() * error.clone()).mean_dim(1).mul_scalar(0.5);
    (loss, error.div_scalar(batch))
}

/// Weighted negative log-likelihood of the data's actions under a Gaussian of this standard deviation, and its gradient in the
/// mean.
pub(super) fn regression_loss(
    mean: Tensor<3>,
    actions: Tensor<3>,
    weight: Tensor<3>,
    std: f64,
) -> (Tensor<3>, Tensor<3>) {
    let [_, batch, width] = mean.dims();
    let z = (actions - mean).div_scalar(std);
    let constant = (std.ln() + 0.5 * std::f64::consts::TAU.ln()) * width as f64;
    let log_prob = (z.clone() * z.clone()).mul_scalar(-0.5).sum_dim(2);
    let loss = (weight.clone() * log_prob.sub_scalar(constant))
        .mean_dim(1)
        .neg();
    (loss, (z * weight).div_scalar(-std * batch as f64))
}
