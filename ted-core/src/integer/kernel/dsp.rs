//! The dot product in the DSP instructions of a Cortex-M: four weights a load, two products an instruction.

use super::{ROWS, dot};
use crate::cortex_m::{AllPairs, COLUMNS, add_dot_i8};
use crate::limits::MAX_WIDTH;

/// A layer's input in pairs, made once a layer.
pub(super) struct Activations(AllPairs);

impl Activations {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self([[0; 2]; MAX_WIDTH / COLUMNS])
    }

    /// Takes the input over, in the order that [`add_dot_i8`] asks for.
    #[inline(never)]
    pub(super) fn take(&mut self, x: &[i16]) {
        let (words, rest) = x.as_chunks::<COLUMNS>();
        let mut pairs = self.0.iter_mut();
        for (word, pairs) in words.iter().zip(pairs.by_ref()) {
            *pairs = in_pairs(word);
        }
        let mut last = [0; COLUMNS];
        for (last, &x) in last.iter_mut().rev().zip(rest.iter().rev()) {
            *last = x;
        }
        if let Some(pairs) = pairs.next() {
            *pairs = in_pairs(&last);
        }
    }

    /// Adds to each sum the dot product of its row with the input.
    #[inline(always)]
    pub(super) fn add_dot(&self, rows: &[i8], x: &[i16], sums: &mut [i32; ROWS]) {
        if x.len() >= COLUMNS {
            add_dot_i8(rows, x.len(), &self.0, sums);
        } else {
            for (sum, row) in sums.iter_mut().zip(rows.chunks_exact(x.len().max(1))) {
                *sum = sum.wrapping_add(dot(row, x));
            }
        }
    }
}

#[inline(always)]
fn in_pairs(&[a, b, c, d]: &[i16; COLUMNS]) -> [u32; 2] {
    let pair = |low: i16, high: i16| u32::from(low as u16) | u32::from(high as u16) << 16;
    [pair(a, c), pair(b, d)]
}
