//! The one loss, with its gradient in both halves of the network's output.

use burn::tensor::Tensor;

/// `mean (f0 + c f1 - a)^2` over batch and coordinates, `[lane, 1, 1]`, and its gradient in `(f0, f1)`, which are the two halves
/// of `heads` `[lane, batch, 2 action]`; `conditions` are `[lane, batch, 1]`.
pub(super) fn conditioned_loss(
    heads: Tensor<3>,
    conditions: Tensor<3>,
    actions: Tensor<3>,
) -> (Tensor<3>, Tensor<3>) {
    let [_, batch, width] = actions.dims();
    let average = heads.clone().narrow(2, 0, width);
    let slope = heads.narrow(2, width, width);
    let error = average + conditions.clone() * slope - actions;
    let loss = (error.clone() * error.clone()).mean_dims(&[1, 2]);
    let d_average = error.mul_scalar(2.0 / (batch * width) as f64);
    let d_slope = conditions * d_average.clone();
    (loss, Tensor::cat(vec![d_average, d_slope], 2))
}
