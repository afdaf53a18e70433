//! From what the transformer says of each step to rewards, and to the score of a clip.

use burn::tensor::{Device, Tensor};
use rand::Rng;

use crate::nn::transformer::{backward, dense, forward, softmax, softmax_gradient, tensors};
use crate::nn::{Linear, mask_inactive};

use super::config::RewardHead;

/// Parameters; also the type of their gradients.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is one of it")]
pub(super) enum Head {
    PerStep {
        /// `[1, width, width / 2]`, with ReLU.
        hidden: Linear,
        /// `[1, width / 2, 1]`.
        output: Linear,
    },
    WeightedSum {
        /// `[1, width, 2 width + 1]`: query, key and reward.
        projection: Linear,
    },
}

/// What the backward pass needs.
#[expect(clippy::large_enum_variant, reason = "there is one of it")]
pub(super) enum HeadTape {
    PerStep {
        input: Tensor<3>,
        active: Tensor<3>,
        steps: usize,
    },
    WeightedSum {
        input: Tensor<3>,
        /// `[clip, step, width]`.
        query: Tensor<3>,
        key: Tensor<3>,
        /// `[clip, step, 1]`.
        reward: Tensor<3>,
        /// `[clip, step, step]`.
        weights: Tensor<3>,
    },
}

impl Head {
    pub(super) fn new(kind: RewardHead, width: usize, rng: &mut impl Rng, device: &Device) -> Self {
        match kind {
            RewardHead::PerStep => Self::PerStep {
                hidden: dense(width, width / 2, rng, device),
                output: dense(width / 2, 1, rng, device),
            },
            RewardHead::WeightedSum => Self::WeightedSum {
                projection: dense(width, 2 * width + 1, rng, device),
            },
        }
    }

    pub(super) fn tensors(&mut self) -> Vec<&mut Tensor<3>> {
        match self {
            Self::PerStep { hidden, output } => {
                [hidden, output].into_iter().flat_map(tensors).collect()
            }
            Self::WeightedSum { projection } => tensors(projection).into(),
        }
    }

    /// Rewards `[1, rows, 1]` of the transformer's outputs `[1, rows, width]`.
    pub(super) fn rewards(&self, h: Tensor<3>) -> Tensor<3> {
        match self {
            Self::PerStep { hidden, output } => forward(output, forward(hidden, h, true), false),
            Self::WeightedSum { projection } => {
                let last = projection.bias.dims()[2] - 1;
                let reward = Linear {
                    weight: projection.weight.clone().narrow(2, last, 1),
                    bias: projection.bias.clone().narrow(2, last, 1),
                };
                forward(&reward, h, false)
            }
        }
    }

    /// Scores `[clips, 1, 1]` of the outputs `[1, clips * steps, width]`.
    pub(super) fn scores(&self, h: Tensor<3>, clips: usize) -> (Tensor<3>, HeadTape) {
        let [_, rows, width] = h.dims();
        let steps = rows / clips;
        match self {
            Self::PerStep { hidden, output } => {
                let active = forward(hidden, h.clone(), true);
                let rewards = forward(output, active.clone(), false);
                let tape = HeadTape::PerStep {
                    input: h,
                    active,
                    steps,
                };
                (rewards.reshape([clips, steps, 1]).mean_dim(1), tape)
            }
            Self::WeightedSum { projection } => {
                let all = forward(projection, h.clone(), false);
                let all = all.reshape([clips, steps, 2 * width + 1]);
                let query = all.clone().narrow(2, 0, width);
                let key = all.clone().narrow(2, width, width);
                let reward = all.narrow(2, 2 * width, 1);
                let scores = query.clone().matmul(key.clone().swap_dims(1, 2));
                let weights = softmax(scores, None);
                let mixed = weights.clone().matmul(reward.clone());
                let tape = HeadTape::WeightedSum {
                    input: h,
                    query,
                    key,
                    reward,
                    weights,
                };
                (mixed.mean_dim(1), tape)
            }
        }
    }

    /// Gradients of the parameters and of the outputs, from the gradient in the scores.
    pub(super) fn backward(&self, tape: HeadTape, d_scores: Tensor<3>) -> (Self, Tensor<3>) {
        let clips = d_scores.dims()[0];
        let each = |steps: usize| {
            let d = d_scores.clone().div_scalar(steps as f64);
            d.expand([clips, steps, 1])
        };
        match (self, tape) {
            (
                Self::PerStep { hidden, output },
                HeadTape::PerStep {
                    input,
                    active,
                    steps,
                },
            ) => {
                let d_rewards = each(steps).reshape([1, clips * steps, 1]);
                let (d_output, d_active) = backward(output, active.clone(), d_rewards);
                let d_active = mask_inactive(d_active, active);
                let (d_hidden, d_h) = backward(hidden, input, d_active);
                let gradients = Self::PerStep {
                    hidden: d_hidden,
                    output: d_output,
                };
                (gradients, d_h)
            }
            (
                Self::WeightedSum { projection },
                HeadTape::WeightedSum {
                    input,
                    query,
                    key,
                    reward,
                    weights,
                },
            ) => {
                let [_, steps, width] = query.dims();
                let d_mixed = each(steps);
                let d_reward = weights.clone().swap_dims(1, 2).matmul(d_mixed.clone());
                let d_weights = d_mixed.matmul(reward.swap_dims(1, 2));
                let d = softmax_gradient(weights, d_weights);
                let d_query = d.clone().matmul(key);
                let d_key = d.swap_dims(1, 2).matmul(query);
                let d_all = Tensor::cat(vec![d_query, d_key, d_reward], 2);
                let d_all = d_all.reshape([1, clips * steps, 2 * width + 1]);
                let (d_projection, d_h) = backward(projection, input, d_all);
                let gradients = Self::WeightedSum {
                    projection: d_projection,
                };
                (gradients, d_h)
            }
            _ => unreachable!("a tape is used by the head that wrote it"),
        }
    }
}
