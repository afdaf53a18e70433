//! The three matrix products of a wide layer, each with what comes before and after it in the same pass.
//!
//! A tile of 8 rows (4 where there are 16 registers) by two vectors stays in registers over the whole contraction. Each
//! number of a result is one chain of multiply-adds over rising indices, wherever its tile lies and however wide a register
//! is, so that no bit depends on how the work is cut up.

use pulp::{Simd, WithSimd};

use super::layout::{Row, TILE, WIDTH, ZERO, panels};

/// Vectors that a tile is wide.
pub(super) const VECTORS: usize = 2;

/// Rows of a tile on a machine with 16 vector registers.
const SMALL_TILE: usize = 4;

/// Sums of a tile with `M` rows.
pub(super) type Tile<S, const M: usize> = [[<S as Simd>::f32s; VECTORS]; M];

/// What happens to the sums of a tile before they are stored.
#[derive(Clone, Copy)]
pub(super) enum Finish<'a> {
    /// Nothing.
    Store,
    /// `max(sum, 0)`; a sum that is not a number stays one, so that a learner that diverged is noticed.
    Relu,
    /// Zero where this matrix, of the result's shape, is not positive: what ReLU did not let through.
    Mask(&'a [Row]),
}

/// `out = finish(left * right + bias)`.
pub(super) struct Product<'a> {
    /// Panels of the left side `[rows, inner]`.
    pub(super) left: &'a [Row],
    /// Rows of the left side and of the result, a multiple of the largest tile.
    pub(super) rows: usize,
    /// Panels of the right side `[inner, columns]`, with one more row for the bias if there is one.
    pub(super) right: &'a [Row],
    /// Columns of the left side.
    pub(super) inner: usize,
    /// Whether the right side's panels end in a row of biases.
    pub(super) bias: bool,
    pub(super) finish: Finish<'a>,
    /// Panels of the result `[rows, columns]`.
    pub(super) out: &'a mut [Row],
}

impl WithSimd for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        if S::REGISTER_COUNT > 16 {
            self.tiles::<S, TILE>(simd);
        } else {
            self.tiles::<S, SMALL_TILE>(simd);
        }
    }
}

impl Product<'_> {
    #[inline(always)]
    fn tiles<S: Simd, const M: usize>(self, simd: S) {
        let panel_rows = self.inner + usize::from(self.bias);
        let right = self.right.chunks_exact(panel_rows);
        for (p, (right, out)) in right.zip(self.out.chunks_exact_mut(self.rows)).enumerate() {
            let (right, bias) = right.split_at(self.inner);
            let bias = bias.first().unwrap_or(&ZERO);
            for (tile, out) in out.as_chunks_mut::<M>().0.iter_mut().enumerate() {
                for at in (0..WIDTH / S::F32_LANES).step_by(VECTORS) {
                    let mut sums: Tile<S, M> = [load::<S>(bias, at); M];
                    let left = self.left.chunks_exact(self.rows);
                    for (left, right) in left.zip(right.chunks(WIDTH)) {
                        let left = &left.as_chunks::<M>().0[tile];
                        for (k, right) in (0..WIDTH).zip(right) {
                            let column = std::array::from_fn(|m| left[m].0[k]);
                            multiply_add(simd, &mut sums, column, load::<S>(right, at));
                        }
                    }
                    match self.finish {
                        Finish::Store => {}
                        Finish::Relu => relu(simd, &mut sums),
                        Finish::Mask(active) => {
                            let active = &active[p * self.rows..].as_chunks::<M>().0[tile];
                            mask(simd, &mut sums, active, at);
                        }
                    }
                    store::<S, M>(&sums, at, out);
                }
            }
        }
    }
}

/// One panel of a wide layer's gradient: `weight += left^T * delta` and, in the last row, `bias += sum of delta`, over blocks
/// of a batch.
pub(super) struct Gradient<'a> {
    /// Of each block: the panels of the layer's input, and one panel of the gradient in its output.
    pub(super) blocks: &'a [(&'a [Row], &'a [Row])],
    /// Whether these are the first blocks, so that what `out` holds is of no interest.
    pub(super) fresh: bool,
    /// Inputs of the layer, and the bias.
    pub(super) out: &'a mut [Row],
}

impl WithSimd for Gradient<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        if S::REGISTER_COUNT > 16 {
            self.tiles::<S, TILE>(simd);
        } else {
            self.tiles::<S, SMALL_TILE>(simd);
        }
    }
}

impl Gradient<'_> {
    #[inline(always)]
    fn tiles<S: Simd, const M: usize>(self, simd: S) {
        let Some((bias, weights)) = self.out.split_last_mut() else {
            return;
        };
        let start = if self.fresh { ZERO } else { *bias };
        for at in (0..WIDTH / S::F32_LANES).step_by(VECTORS) {
            let mut sums = load::<S>(&start, at);
            for row in self.blocks.iter().flat_map(|(_, delta)| *delta) {
                for (sum, delta) in sums.iter_mut().zip(load::<S>(row, at)) {
                    *sum = simd.add_f32s(*sum, delta);
                }
            }
            store::<S, 1>(&[sums], at, std::slice::from_mut(bias));
        }
        for (p, weights) in weights.chunks_mut(WIDTH).enumerate() {
            for (tile, out) in weights.chunks_mut(M).enumerate() {
                for at in (0..WIDTH / S::F32_LANES).step_by(VECTORS) {
                    let mut sums: Tile<S, M> = [load::<S>(&ZERO, at); M];
                    if !self.fresh {
                        for (sums, out) in sums.iter_mut().zip(&*out) {
                            *sums = load::<S>(out, at);
                        }
                    }
                    for (left, delta) in self.blocks {
                        let left = &left[p * delta.len()..];
                        for (left, delta) in left.iter().zip(*delta) {
                            let column = left.0.as_chunks::<M>().0[tile];
                            multiply_add(simd, &mut sums, column, load::<S>(delta, at));
                        }
                    }
                    store::<S, M>(&sums, at, out);
                }
            }
        }
    }
}

/// `sums[m] += column[m] * row`.
#[inline(always)]
fn multiply_add<S: Simd, const M: usize>(
    simd: S,
    sums: &mut Tile<S, M>,
    column: [f32; M],
    row: [S::f32s; VECTORS],
) {
    for (sums, left) in sums.iter_mut().zip(column) {
        let left = simd.splat_f32s(left);
        for (sum, right) in sums.iter_mut().zip(row) {
            *sum = simd.mul_add_e_f32s(left, right, *sum);
        }
    }
}

#[inline(always)]
fn relu<S: Simd, const M: usize>(simd: S, sums: &mut Tile<S, M>) {
    let zero = simd.splat_f32s(0.0);
    for sum in sums.as_flattened_mut() {
        *sum = simd.select_f32s(simd.less_than_f32s(*sum, zero), zero, *sum);
    }
}

#[inline(always)]
fn mask<S: Simd, const M: usize>(simd: S, sums: &mut Tile<S, M>, active: &[Row; M], at: usize) {
    let zero = simd.splat_f32s(0.0);
    for (sums, active) in sums.iter_mut().zip(active) {
        for (sum, active) in sums.iter_mut().zip(load::<S>(active, at)) {
            *sum = simd.select_f32s(simd.less_than_f32s(zero, active), *sum, zero);
        }
    }
}

/// The vectors of a row from vector `at` on.
#[inline(always)]
pub(super) fn load<S: Simd>(row: &Row, at: usize) -> [S::f32s; VECTORS] {
    let (vectors, _) = S::as_simd_f32s(&row.0);
    std::array::from_fn(|v| vectors[at + v])
}

/// Stores as many rows of a tile as there are.
#[inline(always)]
pub(super) fn store<S: Simd, const M: usize>(sums: &Tile<S, M>, at: usize, out: &mut [Row]) {
    for (sums, out) in sums.iter().zip(out) {
        let (vectors, _) = S::as_mut_simd_f32s(&mut out.0);
        vectors[at..at + VECTORS].copy_from_slice(sums);
    }
}

/// The weights of a wide layer `[in, out]` turned to panels of `[out, in]`; columns that fill up are left as they are.
pub(super) fn transpose(weights: &[Row], inputs: usize, outputs: usize, turned: &mut [Row]) {
    for (p, weights) in weights.chunks_exact(inputs + 1).enumerate() {
        let columns = (outputs - p * WIDTH).min(WIDTH);
        for (q, weights) in weights[..inputs].chunks(WIDTH).enumerate() {
            let turned = &mut turned[q * outputs + p * WIDTH..][..columns];
            for (column, turned) in turned.iter_mut().enumerate() {
                for (turned, weights) in turned.0.iter_mut().zip(weights) {
                    *turned = weights.0[column % WIDTH];
                }
            }
        }
    }
    debug_assert_eq!(turned.len(), panels(inputs) * outputs);
}
