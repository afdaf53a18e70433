//! Attention with several heads: what every read token takes from the tokens that it may look at.
//!
//! ```text
//! attention(n) = [ dropout(softmax(q_h k_h^T / sqrt(d))) v_h ]  over heads h,      q = n W_q + b_q, and so on
//! ```

use burn::tensor::{Device, Tensor};
use rand::Rng;

use super::dense::{backward, dense, forward, tensors};
use super::dropout::{Dropout, masked};
use super::sequences::Sequences;
use super::softmax::{softmax, softmax_gradient};
use crate::nn::Linear;

/// Projections; also the type of their gradients.
#[derive(Clone, Debug)]
pub(super) struct Attention {
    /// `[1, width, width]`, heads side by side.
    pub(super) query: Linear,
    /// `[1, width, 2 width]`: the keys of all heads, then the values.
    pub(super) key_value: Linear,
    /// `[1, width, width]`.
    pub(super) output: Linear,
    pub(super) heads: usize,
    causal: bool,
}

/// What the backward pass needs.
pub(super) struct AttentionTape {
    read: Tensor<3>,
    all: Tensor<3>,
    /// `[sequence, head, read token, d]`, divided by the root of d.
    query: Tensor<4>,
    /// `[sequence, head, token, d]`.
    key: Tensor<4>,
    value: Tensor<4>,
    /// `[sequence, head, read token, token]`.
    weights: Tensor<4>,
    mask: Option<Tensor<4>>,
    merged: Tensor<3>,
}

impl Attention {
    pub(super) fn new(
        width: usize,
        heads: usize,
        causal: bool,
        rng: &mut impl Rng,
        device: &Device,
    ) -> Self {
        Self {
            query: dense(width, width, rng, device),
            key_value: dense(width, 2 * width, rng, device),
            output: dense(width, width, rng, device),
            heads,
            causal,
        }
    }

    pub(super) fn tensors(&mut self) -> Vec<&mut Tensor<3>> {
        let layers = [&mut self.query, &mut self.key_value, &mut self.output];
        layers.into_iter().flat_map(tensors).collect()
    }

    /// From normalised rows `[1, rows, width]` to `[1, read rows, width]`.
    pub(super) fn forward(
        &self,
        all: Tensor<3>,
        sequences: Sequences,
        dropout: &Dropout,
        place: &str,
    ) -> (Tensor<3>, AttentionTape) {
        let Sequences { count, tokens, .. } = sequences;
        let device = all.device();
        let read = sequences.readout.pick(all.clone());
        let query = forward(&self.query, read.clone(), false);
        let query = self.split(query, count, self.heads);
        let query = query.mul_scalar(self.scale());
        let both = forward(&self.key_value, all.clone(), false);
        let both = self.split(both, count, 2 * self.heads);
        let key = both.clone().narrow(1, 0, self.heads);
        let value = both.narrow(1, self.heads, self.heads);

        let scores = query.clone().matmul(key.clone().swap_dims(2, 3));
        let weights = softmax(scores, self.causal.then_some(sequences.readout));
        let shape = [count, self.heads, sequences.read(), tokens];
        let mask = dropout.mask(&format!("{place}/attention"), shape, &device);
        let mixed = masked(weights.clone(), mask.as_ref()).matmul(value.clone());
        let merged = merge(mixed);
        let y = forward(&self.output, merged.clone(), false);
        let tape = AttentionTape {
            read,
            all,
            query,
            key,
            value,
            weights,
            mask,
            merged,
        };
        (y, tape)
    }

    /// Gradients of the projections, and the gradients in the rows as they are read and as they are looked at.
    pub(super) fn backward(
        &self,
        tape: AttentionTape,
        d_y: Tensor<3>,
    ) -> (Self, Tensor<3>, Tensor<3>) {
        let count = tape.query.dims()[0];
        let (output, d_merged) = backward(&self.output, tape.merged, d_y);
        let d_mixed = self.split(d_merged, count, self.heads);
        let dropped = masked(tape.weights.clone(), tape.mask.as_ref());
        let d_value = dropped.swap_dims(2, 3).matmul(d_mixed.clone());
        let d_weights = d_mixed.matmul(tape.value.swap_dims(2, 3));
        let d_weights = masked(d_weights, tape.mask.as_ref());
        let d_scores = softmax_gradient(tape.weights, d_weights);
        let d_query = d_scores.clone().matmul(tape.key).mul_scalar(self.scale());
        let d_key = d_scores.swap_dims(2, 3).matmul(tape.query);

        let (query, d_read) = backward(&self.query, tape.read, merge(d_query));
        let d_both = merge(Tensor::cat(vec![d_key, d_value], 1));
        let (key_value, d_all) = backward(&self.key_value, tape.all, d_both);
        let gradients = Self {
            query,
            key_value,
            output,
            ..*self
        };
        (gradients, d_read, d_all)
    }

    /// `[1, count * n, heads * d] -> [count, heads, n, d]`.
    fn split(&self, x: Tensor<3>, count: usize, heads: usize) -> Tensor<4> {
        let [_, rows, width] = x.dims();
        x.reshape([count, rows / count, heads, width / heads])
            .swap_dims(1, 2)
    }

    /// One over the root of a head's width.
    pub(super) fn scale(&self) -> f64 {
        let width = self.query.weight.dims()[1];
        1.0 / ((width / self.heads) as f64).sqrt()
    }
}

/// `[count, heads, n, d] -> [1, count * n, heads * d]`.
fn merge(x: Tensor<4>) -> Tensor<3> {
    let [count, heads, n, d] = x.dims();
    x.swap_dims(1, 2).reshape([1, count * n, heads * d])
}
