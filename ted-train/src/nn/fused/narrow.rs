//! A narrow last layer: a few dot products for each row, and outer products on the way back.

use pulp::{Simd, WithSimd};

use super::layout::{Row, WIDTH, ZERO};
use super::product::{VECTORS, load, store};

/// `out[row][o] = left[row] . weights[o] + bias[o]`.
pub(super) struct Heads<'a> {
    /// Panels of the layer's input.
    pub(super) left: &'a [Row],
    /// Rows of the layer.
    pub(super) layer: &'a [Row],
    pub(super) outputs: usize,
    /// One panel: as many rows as the input has.
    pub(super) out: &'a mut [Row],
}

impl WithSimd for Heads<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Some((biases, weights)) = self.layer.split_last() else {
            return;
        };
        let (rows, panels) = (self.out.len(), weights.len() / self.outputs);
        for (r, out) in self.out.iter_mut().enumerate() {
            *out = ZERO;
            let heads = weights.chunks_exact(panels).zip(&biases.0);
            for (out, (weights, bias)) in out.0.iter_mut().zip(heads) {
                let mut sum = simd.splat_f32s(0.0);
                for (panel, weights) in self.left.chunks_exact(rows).zip(weights) {
                    let (left, _) = S::as_simd_f32s(&panel[r].0);
                    let (right, _) = S::as_simd_f32s(&weights.0);
                    for (&left, &right) in left.iter().zip(right) {
                        sum = simd.mul_add_e_f32s(left, right, sum);
                    }
                }
                *out = simd.reduce_sum_f32s(sum) + bias;
            }
        }
    }
}

/// `out = delta * weights`, zero where `active`, of the same shape, is not positive.
pub(super) struct HeadsBack<'a> {
    /// The gradient in the output: one panel.
    pub(super) delta: &'a [Row],
    /// Rows of the layer.
    pub(super) layer: &'a [Row],
    pub(super) outputs: usize,
    pub(super) active: &'a [Row],
    pub(super) out: &'a mut [Row],
}

impl WithSimd for HeadsBack<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let (rows, zero) = (self.delta.len(), simd.splat_f32s(0.0));
        let panels = (self.layer.len() - 1) / self.outputs;
        let out = self.out.chunks_exact_mut(rows);
        for (p, (out, active)) in out.zip(self.active.chunks_exact(rows)).enumerate() {
            for ((out, active), delta) in out.iter_mut().zip(active).zip(self.delta) {
                let (out, _) = S::as_mut_simd_f32s(&mut out.0);
                let (active, _) = S::as_simd_f32s(&active.0);
                for (v, (out, &active)) in out.iter_mut().zip(active).enumerate() {
                    let mut sum = zero;
                    for (o, &delta) in delta.0[..self.outputs].iter().enumerate() {
                        let (weights, _) = S::as_simd_f32s(&self.layer[o * panels + p].0);
                        sum = simd.mul_add_e_f32s(simd.splat_f32s(delta), weights[v], sum);
                    }
                    *out = simd.select_f32s(simd.less_than_f32s(zero, active), sum, zero);
                }
            }
        }
    }
}

/// The gradient of the layer itself, over the blocks of a batch.
pub(super) struct HeadsGradient<'a> {
    /// Of each block: the panels of the layer's input, and the gradient in its output, one panel.
    pub(super) blocks: &'a [(&'a [Row], &'a [Row])],
    pub(super) outputs: usize,
    /// Rows of the layer.
    pub(super) out: &'a mut [Row],
}

impl WithSimd for HeadsGradient<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Some((biases, weights)) = self.out.split_last_mut() else {
            return;
        };
        *biases = ZERO;
        for row in self.blocks.iter().flat_map(|(_, delta)| *delta) {
            for (bias, delta) in biases.0[..self.outputs].iter_mut().zip(&row.0) {
                *bias += delta;
            }
        }
        let panels = weights.len() / self.outputs;
        for (o, weights) in weights.chunks_exact_mut(panels).enumerate() {
            let o = o % WIDTH;
            for (p, weights) in weights.iter_mut().enumerate() {
                for at in (0..WIDTH / S::F32_LANES).step_by(VECTORS) {
                    let mut sums = load::<S>(&ZERO, at);
                    for (left, delta) in self.blocks {
                        for (left, delta) in left[p * delta.len()..].iter().zip(*delta) {
                            let delta = simd.splat_f32s(delta.0[o]);
                            for (sum, left) in sums.iter_mut().zip(load::<S>(left, at)) {
                                *sum = simd.mul_add_e_f32s(delta, left, *sum);
                            }
                        }
                    }
                    store::<S, 1>(&[sums], at, std::slice::from_mut(weights));
                }
            }
        }
    }
}
