//! Softmax over the last axis, with a mask that lets a query see the keys up to its own place only.

use burn::tensor::Tensor;
use rayon::prelude::*;

use super::sequences::Readout;
use crate::nn::host::in_place;

/// Rows that one job takes at least.
const ROWS: usize = 64;

/// `scores [.., queries, keys]` to weights that sum to 1 over the keys. With `causal`, query `i` of the readout sees the keys
/// up to its own place and the others have weight 0.
pub(crate) fn softmax<const D: usize>(mut scores: Tensor<D>, causal: Option<Readout>) -> Tensor<D> {
    let [queries, keys] = last_axes(&scores);
    in_place([&mut scores], |[scores]| {
        let rows = scores.par_chunks_mut(keys).enumerate().with_min_len(ROWS);
        rows.for_each(|(row, scores)| {
            let seen = causal.map_or(keys, |readout| readout.place(row % queries) + 1);
            let (seen, hidden) = scores.split_at_mut(seen);
            let largest = seen.iter().copied().fold(f32::NEG_INFINITY, f32::max);
            seen.iter_mut().for_each(|s| *s = (*s - largest).exp());
            let sum = seen.iter().sum::<f32>();
            seen.iter_mut().for_each(|s| *s /= sum);
            hidden.fill(0.0);
        });
    });
    scores
}

/// The gradient in the scores, from the weights and the gradient in them.
pub(crate) fn softmax_gradient<const D: usize>(
    mut weights: Tensor<D>,
    mut d_weights: Tensor<D>,
) -> Tensor<D> {
    let [_, keys] = last_axes(&weights);
    in_place([&mut d_weights, &mut weights], |[d_weights, weights]| {
        let rows = d_weights.par_chunks_mut(keys).zip(weights.par_chunks(keys));
        rows.with_min_len(ROWS).for_each(|(d, weights)| {
            let mean = super::norm::dot(d, weights);
            for (d, weight) in d.iter_mut().zip(weights) {
                *d = weight * (*d - mean);
            }
        });
    });
    d_weights
}

fn last_axes<const D: usize>(tensor: &Tensor<D>) -> [usize; 2] {
    let dims = tensor.dims();
    [dims[D - 2], dims[D - 1]]
}
