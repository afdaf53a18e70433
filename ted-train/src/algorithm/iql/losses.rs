//! The three losses, each with its gradient in the outputs of the network it trains.
//!
//! Shapes: `[lane, batch, 1]` for values, `[lane, batch, action]` for actions. A loss is the mean over the batch and is
//! returned per lane as `[lane, 1, 1]`.

use burn::tensor::Tensor;

use super::IqlConfig;

/// `mean |tau - 1(u < 0)| u^2` with `u = q - v`, and its gradient in `v` (paper Eq. 6, L_V).
pub(super) fn expectile_loss(q: Tensor<3>, v: Tensor<3>, tau: f64) -> (Tensor<3>, Tensor<3>) {
    let batch = v.dims()[1] as f64;
    let u = q - v;
    // tau where u >= 0 and 1 - tau where u < 0.
    let weight = u
        .clone()
        .lower_elem(0.0)
        .float()
        .mul_scalar(1.0 - 2.0 * tau)
        .add_scalar(tau);
    let weighted = weight * u.clone();
    let loss = (weighted.clone() * u).mean_dim(1);
    (loss, weighted.mul_scalar(-2.0 / batch))
}

/// Advantage-weighted negative log-likelihood of the data's actions under a diagonal Gaussian, and its gradients in the
/// mean and in the log standard deviation `[lane, 1, action]` (paper Eq. 6, L_pi).
pub(super) fn policy_loss(
    mean: Tensor<3>,
    log_std: Tensor<3>,
    actions: Tensor<3>,
    advantage: Tensor<3>,
    config: &IqlConfig,
) -> (Tensor<3>, Tensor<3>, Tensor<3>) {
    let [_, batch, width] = mean.dims();
    let weight = advantage
        .mul_scalar(config.beta)
        .exp()
        .clamp_max(config.advantage_clip);
    let clipped = log_std.clone().clamp(config.log_std[0], config.log_std[1]);
    let inverse_std = clipped.clone().neg().exp();
    let z = (actions - mean) * inverse_std.clone();
    let z_squared = z.clone() * z.clone();

    let constant = 0.5 * (std::f64::consts::TAU).ln() * width as f64;
    let log_prob = (z_squared.clone().mul_scalar(-0.5) - clipped)
        .sum_dim(2)
        .add_scalar(-constant);
    let loss = (weight.clone() * log_prob).mean_dim(1).neg();

    let scaled = weight.div_scalar(batch as f64);
    let d_mean = (scaled.clone() * z * inverse_std).neg();
    // The clip is flat outside its range, so no gradient reaches the parameter there.
    let inside = log_std
        .clone()
        .greater_equal_elem(config.log_std[0])
        .float()
        * log_std.lower_equal_elem(config.log_std[1]).float();
    let d_log_std = (scaled * z_squared.sub_scalar(1.0)).sum_dim(1).neg() * inside;
    (loss, d_mean, d_log_std)
}

/// `mean (q - y)^2` of every head, and its gradient in `q`; the critic loss is the sum over heads (paper Eq. 7).
pub(super) fn critic_loss(q: Tensor<3>, y: Tensor<3>) -> (Tensor<3>, Tensor<3>) {
    let batch = q.dims()[1] as f64;
    let error = q - y;
    (
        (error.clone() * error.clone()).mean_dim(1),
        error.mul_scalar(2.0 / batch),
    )
}
