//! The Bellman error of a critic with its gradients, and how two losses with a weight between them are added.

use burn::tensor::Tensor;

/// What a loss and the penalty beside it are multiplied by, so that neither weighs more than it does alone.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Shares<T> {
    pub(super) loss: T,
    pub(super) penalty: T,
}

impl Shares<f64> {
    /// `loss / weight + penalty` for a weight above one, `loss + weight * penalty` below (the original's `normalized_sum`).
    pub(super) fn of(weight: f64) -> Self {
        Self {
            loss: 1.0 / weight.max(1.0),
            penalty: weight.min(1.0),
        }
    }
}

impl Shares<Tensor<3>> {
    /// The same with a weight for each lane.
    pub(super) fn of_lanes(weight: Tensor<3>) -> Self {
        Self {
            loss: weight.clone().clamp_min(1.0).recip(),
            penalty: weight.clamp_max(1.0),
        }
    }
}

/// Half the squared distance to the target's `y` and half the squared residual of the critic's own equation (DQRA), averaged
/// over the batch, and the gradients in `q = Q(s, a)` and in `q_next = Q(s', a')`. All are `[lane, batch, 1]`, the loss
/// `[lane, 1, 1]`.
pub(super) fn bellman_loss(
    q: Tensor<3>,
    q_next: Tensor<3>,
    y: Tensor<3>,
    reward: Tensor<3>,
    discount: Tensor<3>,
) -> (Tensor<3>, Tensor<3>, Tensor<3>) {
    let batch = q.dims()[1] as f64;
    let to_target = q.clone() - y;
    let residual = q - reward - discount.clone() * q_next;
    let squares = to_target.clone() * to_target.clone() + residual.clone() * residual.clone();
    let d_q = (to_target + residual.clone()).div_scalar(batch);
    let d_q_next = (residual * discount).div_scalar(-batch);
    (squares.mean_dim(1).mul_scalar(0.5), d_q, d_q_next)
}
