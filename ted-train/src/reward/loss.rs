//! Bradley-Terry cross-entropy with soft labels (paper Eq. 2 and 3).

use burn::tensor::{Tensor, activation::sigmoid};

/// Cross-entropy of pairs of segment returns `[member, pair, 2]` against labels `[member, pair, 1]` (the probability
/// that the second segment is preferred: 0, 1 or 0.5), and its gradient in the returns.
///
/// The loss is the mean over pairs, `[member, 1, 1]`.
pub(super) fn bradley_terry(returns: Tensor<3>, labels: Tensor<3>) -> (Tensor<3>, Tensor<3>) {
    let pairs = returns.dims()[1] as f64;
    let (first, second) = (returns.clone().narrow(2, 0, 1), returns.narrow(2, 1, 1));
    let logit = second - first;
    // -[y log p + (1 - y) log(1 - p)] with p = sigmoid(logit), in the form that cannot overflow.
    let softplus = logit.clone().abs().neg().exp().log1p();
    let loss = logit.clone().clamp_min(0.0) - labels.clone() * logit.clone() + softplus;
    let d_second = (sigmoid(logit) - labels).div_scalar(pairs);
    (
        loss.mean_dim(1),
        Tensor::cat(vec![d_second.clone().neg(), d_second], 2),
    )
}
