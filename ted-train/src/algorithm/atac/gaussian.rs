//! A diagonal Gaussian squashed by tanh: its samples, its likelihood and its entropy, each with the gradient in the output of the
//! network that gives mean and log standard deviation.
//!
//! ```text
//! u = mean + std * noise,    a = tanh(u)
//! log pi(a) = -noise^2 / 2 - log std - log(2 pi) / 2 - log(1 - a^2)      of each coordinate
//! log(1 - tanh(u)^2) = 2 (log 2 - |u| - log(1 + exp(-2 |u|)))            which neither overflows nor cancels
//! ```

use burn::tensor::Tensor;

/// The distribution of each row's action. Shapes are `[lane, batch, action]`.
pub(super) struct Gaussian {
    mean: Tensor<3>,
    log_std: Tensor<3>,
    std: Tensor<3>,
    /// One where the log standard deviation is inside its range, zero where the clip is flat.
    inside: Tensor<3>,
}

/// One action of each row.
pub(super) struct Sample {
    /// After tanh.
    pub(super) action: Tensor<3>,
    /// Standard normal, given from outside.
    noise: Tensor<3>,
    /// Of what is clipped, nothing moves.
    d_std: Tensor<3>,
    inside: Tensor<3>,
    log_prob: Tensor<3>,
}

impl Gaussian {
    /// From the network's output `[lane, batch, 2 action]`, means before logarithms of standard deviations, which are clipped to
    /// `std`.
    pub(super) fn new(output: Tensor<3>, std: [f64; 2]) -> Self {
        let width = output.dims()[2] / 2;
        let [low, high] = std.map(f64::ln);
        let raw = output.clone().narrow(2, width, width);
        let log_std = raw.clone().clamp(low, high);
        Self {
            mean: output.narrow(2, 0, width),
            std: log_std.clone().exp(),
            log_std,
            inside: raw.clone().greater_equal_elem(low).float()
                * raw.lower_equal_elem(high).float(),
        }
    }

    /// The actions that this noise stands for.
    pub(super) fn sample(&self, noise: Tensor<3>) -> Sample {
        let before = self.mean.clone() + self.std.clone() * noise.clone();
        Sample {
            log_prob: self.log_prob(noise.clone(), before.clone()),
            action: before.tanh(),
            d_std: self.std.clone() * noise.clone() * self.inside.clone(),
            inside: self.inside.clone(),
            noise,
        }
    }

    /// Mean of `-log pi(a)` over rows and coordinates `[lane, 1, 1]`, for actions inside (-1, 1), and its gradient in the
    /// network's output.
    pub(super) fn negative_log_likelihood(&self, actions: Tensor<3>) -> (Tensor<3>, Tensor<3>) {
        let before = actions.atanh();
        let z = (before.clone() - self.mean.clone()) / self.std.clone();
        let loss = self.log_prob(z.clone(), before).mean_dims(&[1, 2]).neg();
        let d_mean = (z.clone() / self.std.clone()).neg();
        let d_log_std = (z.clone() * z).neg().add_scalar(1.0) * self.inside.clone();
        let count = count(&d_mean);
        (
            loss,
            Tensor::cat(vec![d_mean, d_log_std], 2).div_scalar(count),
        )
    }

    /// `log pi` of each coordinate, for `u = mean + std z`.
    fn log_prob(&self, z: Tensor<3>, before: Tensor<3>) -> Tensor<3> {
        let normal = (z.clone() * z).mul_scalar(-0.5) - self.log_std.clone();
        let constant = 0.5 * std::f64::consts::TAU.ln();
        normal.sub_scalar(constant) - log_slope(before)
    }
}

impl Sample {
    /// Mean of `-log pi(a)` over rows and coordinates `[lane, 1, 1]`, and the gradient of its *negative* in the network's output.
    pub(super) fn entropy(&self) -> (Tensor<3>, Tensor<3>) {
        let entropy = self.log_prob.clone().mean_dims(&[1, 2]).neg();
        // The slope of -log(1 - tanh(u)^2) is 2 tanh(u).
        let d_mean = self.action.clone().mul_scalar(2.0);
        let d_log_std = d_mean.clone() * self.d_std.clone() - self.inside.clone();
        let d_output = Tensor::cat(vec![d_mean, d_log_std], 2);
        (entropy, d_output.div_scalar(count(&self.noise)))
    }

    /// The gradient in the network's output from that in the actions.
    pub(super) fn through(&self, d_action: Tensor<3>) -> Tensor<3> {
        let slope = (self.action.clone() * self.action.clone())
            .neg()
            .add_scalar(1.0);
        let d_mean = d_action * slope;
        Tensor::cat(vec![d_mean.clone(), d_mean * self.d_std.clone()], 2)
    }
}

/// `log(1 - tanh(u)^2)`.
fn log_slope(before: Tensor<3>) -> Tensor<3> {
    let size = before.abs();
    let tail = size.clone().mul_scalar(-2.0).exp().log1p();
    (size + tail)
        .neg()
        .add_scalar(std::f64::consts::LN_2)
        .mul_scalar(2.0)
}

/// Rows times coordinates.
fn count(of: &Tensor<3>) -> f64 {
    let [_, rows, width] = of.dims();
    (rows * width) as f64
}
