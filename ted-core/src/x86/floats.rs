//! Dense rows in AVX: eight at a time, two rows' four lanes in each register.

use core::arch::x86_64::{
    __m256, __m256i, _MM_HINT_T0, _mm_prefetch, _mm256_add_ps, _mm256_hadd_ps, _mm256_loadu_ps,
    _mm256_loadu_si256, _mm256_maskload_ps, _mm256_mul_ps, _mm256_permute2f128_ps,
    _mm256_setzero_ps, _mm256_storeu_ps,
};

use super::instructions::{AVX, has};

/// Rows computed together: enough that no addition waits for the one before it in the same lane.
const ROWS: usize = 8;

/// Registers of sums. Row `r` shares one with row `r + PAIRS`.
const PAIRS: usize = ROWS / 2;

/// Columns loaded together. They are two terms of each lane, which are added one after the other.
const COLUMNS: usize = 8;

/// Weights from the first of a group to those that are prefetched when it is begun: five kilobytes, the best on a Zen 4. The
/// processor's own guess is late, since no row is long.
const AHEAD: usize = 1280;

/// Computes `out[o] = sum_i weights[o][i] * x[i] + bias[o]` of the first rows, and returns of how many: of all but the last
/// few, or of none where the processor has no AVX.
pub(crate) fn sums(weights: &[f32], bias: &[f32], x: &[f32], out: &mut [f32]) -> usize {
    if !has(AVX) {
        return 0;
    }
    // SAFETY: the processor has AVX.
    unsafe { sums_of_groups(weights, bias, x, out) }
}

#[target_feature(enable = "avx")]
fn sums_of_groups(weights: &[f32], bias: &[f32], x: &[f32], out: &mut [f32]) -> usize {
    let groups = weights.chunks_exact((ROWS * x.len()).max(1));
    let (bias, _) = bias.as_chunks();
    let (out, _) = out.as_chunks_mut();
    let mut rows = 0;
    for ((group, bias), out) in groups.zip(bias).zip(out) {
        sums_of_group(group, bias, x, out);
        rows += ROWS;
    }
    rows
}

#[inline]
#[target_feature(enable = "avx")]
fn sums_of_group(weights: &[f32], bias: &[f32; ROWS], x: &[f32], out: &mut [f32; ROWS]) {
    let inputs = x.len();
    if weights.len() != ROWS * inputs {
        return;
    }
    let mut sums = [_mm256_setzero_ps(); PAIRS];
    // Where the columns begin in the first row of each half, and what will be needed later, in the order it lies in memory.
    let mut lower = weights.as_ptr();
    let mut upper = lower.wrapping_add(PAIRS * inputs);
    let mut ahead = lower.wrapping_add(AHEAD);
    let (blocks, tail) = x.as_chunks::<COLUMNS>();
    for x in blocks {
        // SAFETY: it is as long as a register.
        let x = unsafe { _mm256_loadu_ps(x.as_ptr()) };
        for (r, sum) in sums.iter_mut().enumerate() {
            // A prefetch needs no more than an address, so after the last rows it does no harm.
            _mm_prefetch::<_MM_HINT_T0>(ahead.wrapping_add(2 * COLUMNS * r).cast());
            // SAFETY: each row has as many columns as `x`, and there are twice `PAIRS`.
            let (lower, upper) = unsafe {
                (
                    _mm256_loadu_ps(lower.add(r * inputs)),
                    _mm256_loadu_ps(upper.add(r * inputs)),
                )
            };
            *sum = add(*sum, _mm256_mul_ps(lower, x), _mm256_mul_ps(upper, x));
        }
        lower = lower.wrapping_add(COLUMNS);
        upper = upper.wrapping_add(COLUMNS);
        ahead = ahead.wrapping_add(ROWS * COLUMNS);
    }
    if !tail.is_empty() {
        // What the mask leaves out is not read and counts as +0, which changes no lane: none is ever -0, since each began
        // as +0.
        let mask = first(tail.len());
        // SAFETY: the mask ends where `x` and each row do.
        let x = unsafe { _mm256_maskload_ps(tail.as_ptr(), mask) };
        for (r, sum) in sums.iter_mut().enumerate() {
            _mm_prefetch::<_MM_HINT_T0>(ahead.wrapping_add(2 * COLUMNS * r).cast());
            // SAFETY: as above.
            let (lower, upper) = unsafe {
                (
                    _mm256_maskload_ps(lower.add(r * inputs), mask),
                    _mm256_maskload_ps(upper.add(r * inputs), mask),
                )
            };
            *sum = add(*sum, _mm256_mul_ps(lower, x), _mm256_mul_ps(upper, x));
        }
    }
    // A horizontal addition is of neighbours: lanes 0 and 1, lanes 2 and 3, then of these two.
    let [a, b, c, d] = sums;
    let rows = _mm256_hadd_ps(_mm256_hadd_ps(a, b), _mm256_hadd_ps(c, d));
    // SAFETY: both are as long as a register.
    unsafe {
        let bias = _mm256_loadu_ps(bias.as_ptr());
        _mm256_storeu_ps(out.as_mut_ptr(), _mm256_add_ps(rows, bias));
    }
}

/// Adds the products of one row to the lower four lanes and of another to the upper four, the first four columns first.
#[inline]
#[target_feature(enable = "avx")]
fn add(sum: __m256, lower: __m256, upper: __m256) -> __m256 {
    let first_columns = _mm256_permute2f128_ps::<0x20>(lower, upper);
    let last_columns = _mm256_permute2f128_ps::<0x31>(lower, upper);
    _mm256_add_ps(_mm256_add_ps(sum, first_columns), last_columns)
}

/// A mask of the first `count` columns.
#[inline]
#[target_feature(enable = "avx")]
fn first(count: usize) -> __m256i {
    const MASKS: [i32; 2 * COLUMNS] = [-1, -1, -1, -1, -1, -1, -1, -1, 0, 0, 0, 0, 0, 0, 0, 0];
    let skipped = COLUMNS.saturating_sub(count);
    // SAFETY: at most half of the masks are skipped, and the other half is as long as a register.
    unsafe { _mm256_loadu_si256(MASKS.as_ptr().add(skipped).cast()) }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::*;
    use crate::reference;

    #[test]
    fn every_small_shape_has_the_bits_of_the_reference_in_all_rows_that_are_done() {
        for inputs in 1..=40 {
            for outputs in 1..=2 * ROWS + 1 {
                // All bits of the mantissa.
                let number = |i: usize| {
                    ((i as u32).wrapping_mul(2_654_435_761) >> 8) as f32 / (1 << 23) as f32 - 1.0
                };
                let weights: Vec<f32> = (0..inputs * outputs).map(|i| number(7 * i)).collect();
                let x: Vec<f32> = (0..inputs).map(number).collect();
                let bias: Vec<f32> = (0..outputs).map(|o| number(3 * o)).collect();
                let mut out: Vec<f32> = (0..outputs).map(|_| f32::NAN).collect();
                let done = sums(&weights, &bias, &x, &mut out);
                let groups = match has(AVX) {
                    true => outputs / ROWS,
                    false => 0,
                };
                assert_eq!(done, groups * ROWS);
                let rows = weights.chunks(inputs).zip(&bias).zip(&out);
                for (o, ((row, bias), out)) in rows.enumerate() {
                    if o < done {
                        let expected = reference::dense_row(row, *bias, &x);
                        assert_eq!(out.to_bits(), expected.to_bits(), "{inputs} {o}");
                    } else {
                        assert!(out.is_nan(), "{inputs} {o}");
                    }
                }
            }
        }
    }

    #[test]
    fn lanes_are_added_in_the_order_of_the_reference() {
        // 2^24 swallows a 1 that is added to it; which ones survive shows the order.
        let mut x = [0.0; 13];
        for (x, value) in x
            .iter_mut()
            .zip([16_777_216.0, 1.0, 1.0, 1.0, 1.0, -16_777_216.0, 3.0])
        {
            *x = value;
        }
        let mut out = [0.0; ROWS];
        let done = sums(&[1.0; 13 * ROWS], &[0.5; ROWS], &x, &mut out);
        let expected = reference::dense_row(&[1.0; 13], 0.5, &x);
        assert_eq!(out[..done], [expected; ROWS][..done]);
    }
}
