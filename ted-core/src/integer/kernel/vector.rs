//! The dot product in plain code for machines with vector registers.

use super::ROWS;

/// Columns of one block. All its products are written out at once, of which the compiler for x86-64 makes `pmaddwd`.
const COLUMNS: usize = 32;

/// A layer's input is read as it is.
pub(super) struct Activations;

impl Activations {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self
    }

    #[inline(always)]
    pub(super) fn take(&mut self, _: &[i16]) {}

    /// Adds to each sum the dot product of its row with the input.
    #[inline(always)]
    pub(super) fn add_dot(&self, rows: &[i8], x: &[i16], sums: &mut [i32; ROWS]) {
        let (blocks, rest) = x.as_chunks::<COLUMNS>();
        for (sum, row) in sums.iter_mut().zip(rows.chunks_exact(x.len().max(1))) {
            let (row, row_rest) = row.as_chunks::<COLUMNS>();
            for (row, x) in row.iter().zip(blocks) {
                *sum = sum.wrapping_add(products(row, x));
            }
            *sum = sum.wrapping_add(products(row_rest, rest));
        }
    }
}

#[inline(always)]
fn products(row: &[i8], x: &[i16]) -> i32 {
    let products = row
        .iter()
        .zip(x)
        .map(|(&w, &x)| i32::from(w) * i32::from(x));
    products.fold(0, i32::wrapping_add)
}
