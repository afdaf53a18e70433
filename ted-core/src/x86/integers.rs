//! Dot products of integer rows in AVX2: four rows at a time, sixteen columns in a register.

use core::arch::x86_64::{
    __m256i, _mm_add_epi32, _mm_loadu_si128, _mm_storeu_si128, _mm256_add_epi32,
    _mm256_castsi256_si128, _mm256_cvtepi8_epi16, _mm256_extracti128_si256, _mm256_hadd_epi32,
    _mm256_loadu_si256, _mm256_madd_epi16, _mm256_setzero_si256,
};

use super::instructions::{AVX2, has};

/// Rows computed together: each register of activations is loaded once for them.
const ROWS: usize = 4;

/// Columns computed together.
pub(crate) const COLUMNS: usize = 16;

/// Adds to each sum the dot product of its row with `x`, and says whether it did: not where the processor has no AVX2 or the
/// rows are shorter than a register.
///
/// `last` is the last [`COLUMNS`] of `x`, but zero where they lie in whole blocks from its beginning, so that nothing counts
/// twice.
#[inline]
pub(crate) fn add_dot(
    rows: &[i8],
    x: &[i16],
    last: &[i16; COLUMNS],
    sums: &mut [i32; ROWS],
) -> bool {
    if x.len() < COLUMNS || rows.len() != ROWS * x.len() || !has(AVX2) {
        return false;
    }
    // SAFETY: the processor has AVX2, and the rows are as long as is said there.
    unsafe { add_dot_of_rows(rows, x, last, sums) };
    true
}

/// # Safety
/// There are [`ROWS`] rows, as long as `x`, which has at least [`COLUMNS`] elements.
#[target_feature(enable = "avx2")]
unsafe fn add_dot_of_rows(rows: &[i8], x: &[i16], last: &[i16; COLUMNS], sums: &mut [i32; ROWS]) {
    let inputs = x.len();
    let mut dots = [_mm256_setzero_si256(); ROWS];
    let mut column = 0;
    while column + COLUMNS <= inputs {
        // SAFETY: a register's length of `x` begins at `column`.
        let x = unsafe { _mm256_loadu_si256(x.as_ptr().add(column).cast()) };
        for (r, dot) in dots.iter_mut().enumerate() {
            // SAFETY: and as many columns of each row.
            *dot = unsafe { add_products(*dot, rows.as_ptr().add(r * inputs + column), x) };
        }
        column += COLUMNS;
    }
    if column < inputs {
        // SAFETY: it is as long as a register.
        let x = unsafe { _mm256_loadu_si256(last.as_ptr().cast()) };
        for (r, dot) in dots.iter_mut().enumerate() {
            // SAFETY: a row is at least as long, and this is its end.
            *dot = unsafe { add_products(*dot, rows.as_ptr().add((r + 1) * inputs - COLUMNS), x) };
        }
    }
    let [a, b, c, d] = dots;
    let halves = _mm256_hadd_epi32(_mm256_hadd_epi32(a, b), _mm256_hadd_epi32(c, d));
    let dots = _mm_add_epi32(
        _mm256_castsi256_si128(halves),
        _mm256_extracti128_si256::<1>(halves),
    );
    // SAFETY: the sums are as long as this register.
    unsafe {
        let before = _mm_loadu_si128(sums.as_ptr().cast());
        _mm_storeu_si128(sums.as_mut_ptr().cast(), _mm_add_epi32(before, dots));
    }
}

/// Adds the products of sixteen columns, in pairs. No pair overflows: its largest is 2 * 128 * 32768.
///
/// # Safety
/// [`COLUMNS`] weights begin at `row`.
#[inline]
#[target_feature(enable = "avx2")]
unsafe fn add_products(dot: __m256i, row: *const i8, x: __m256i) -> __m256i {
    // SAFETY: so the caller says.
    let row = unsafe { _mm_loadu_si128(row.cast()) };
    _mm256_add_epi32(dot, _mm256_madd_epi16(_mm256_cvtepi8_epi16(row), x))
}
