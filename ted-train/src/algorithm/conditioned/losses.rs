//! The one loss, with its gradient in both halves of the network's output and in the gain.

use burn::tensor::Tensor;

/// What one batch says of the network's output and of the gain.
pub(super) struct ConditionedLoss {
    /// `mean ((1 + c gain) f0 + c h - a)^2` over batch and coordinates, `[lane, 1, 1]`.
    pub loss: Tensor<3>,
    /// Its gradient in `(f0, h)`, `[lane, batch, 2 action]`.
    pub d_heads: Tensor<3>,
    /// Its gradient in the gain, `[lane, 1, 1]`.
    pub d_gain: Tensor<3>,
}

/// Of `(f0, h)`, which are the two halves of `heads` `[lane, batch, 2 action]`, with one `gain` a lane, `[lane, 1, 1]`;
/// `conditions` are `[lane, batch, 1]`.
pub(super) fn conditioned_loss(
    heads: Tensor<3>,
    gain: Tensor<3>,
    conditions: Tensor<3>,
    actions: Tensor<3>,
) -> ConditionedLoss {
    let [_, batch, width] = actions.dims();
    let average = heads.clone().narrow(2, 0, width);
    let other = heads.narrow(2, width, width);
    let lengthened = (conditions.clone() * gain).add_scalar(1.0);
    let error = lengthened.clone() * average.clone() + conditions.clone() * other - actions;
    let loss = (error.clone() * error.clone()).mean_dims(&[1, 2]);
    let d_action = error.mul_scalar(2.0 / (batch * width) as f64);
    let d_other = conditions * d_action.clone();
    let d_gain = (d_other.clone() * average).sum_dim(1).sum_dim(2);
    ConditionedLoss {
        loss,
        d_heads: Tensor::cat(vec![lengthened * d_action, d_other], 2),
        d_gain,
    }
}
