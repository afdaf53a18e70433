//! The dot product in plain code for cores without vector registers: four weights a load, taken apart in a register.

use super::{ROWS, dot};
use crate::limits::MAX_WIDTH;

/// Weights in a word.
const COLUMNS: usize = 4;

/// Rows computed together: each activation is read once for both, and more would not fit the registers of a Cortex-M.
const TOGETHER: usize = 2;

/// The activations of four columns, two in a word.
type Pairs = [u32; 2];

/// A layer's input in pairs, made once a layer.
///
/// Where the last columns fill no word of weights, they are at the end of one that overlaps with the word before it; what it
/// would count twice is zero in `last`.
pub(super) struct Activations {
    words: [Pairs; MAX_WIDTH / COLUMNS],
    last: Pairs,
}

impl Activations {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self {
            words: [[0; 2]; MAX_WIDTH / COLUMNS],
            last: [0; 2],
        }
    }

    /// Takes the input over.
    #[inline(always)]
    pub(super) fn take(&mut self, x: &[i16]) {
        let (words, rest) = x.as_chunks::<COLUMNS>();
        for (pairs, word) in self.words.iter_mut().zip(words) {
            *pairs = in_pairs(word);
        }
        let mut last = [0; COLUMNS];
        for (last, &x) in last.iter_mut().rev().zip(rest.iter().rev()) {
            *last = x;
        }
        self.last = in_pairs(&last);
    }

    /// Adds to each sum the dot product of its row with the input.
    #[inline(always)]
    pub(super) fn add_dot(&self, rows: &[i8], x: &[i16], sums: &mut [i32; ROWS]) {
        let (sums, _) = sums.as_chunks_mut::<TOGETHER>();
        for (sums, rows) in sums
            .iter_mut()
            .zip(rows.chunks_exact(TOGETHER * x.len().max(1)))
        {
            let (upper, lower) = rows.split_at(rows.len() / TOGETHER);
            let [a, b] = *sums;
            *sums = if let (Some(&last_a), Some(&last_b)) = (upper.last_chunk(), lower.last_chunk())
            {
                let sums = [
                    with_products(a, word(last_a), self.last),
                    with_products(b, word(last_b), self.last),
                ];
                with_dot_of_two_rows(upper.as_chunks().0, lower.as_chunks().0, &self.words, sums)
            } else {
                [a.wrapping_add(dot(upper, x)), b.wrapping_add(dot(lower, x))]
            };
        }
    }
}

#[inline(never)]
fn with_dot_of_two_rows(
    upper: &[[i8; COLUMNS]],
    lower: &[[i8; COLUMNS]],
    pairs: &[Pairs],
    [mut a, mut b]: [i32; TOGETHER],
) -> [i32; TOGETHER] {
    for ((&upper, &lower), &pairs) in upper.iter().zip(lower).zip(pairs) {
        let (upper, lower) = (word(upper), word(lower));
        a = with_products(a, upper, pairs);
        b = with_products(b, lower, pairs);
    }
    [a, b]
}

#[inline(always)]
fn word(weights: [i8; COLUMNS]) -> u32 {
    u32::from_le_bytes(weights.map(|w| w as u8))
}

/// `sum` plus four products, one after the other: each is then one instruction with its addition.
#[inline(always)]
fn with_products(sum: i32, weights: u32, [low, high]: Pairs) -> i32 {
    let w = |column: u32| i32::from((weights >> (8 * column)) as i8);
    let x = |half: u32| i32::from(half as i16);
    sum.wrapping_add(w(0) * x(low))
        .wrapping_add(w(1) * x(low >> 16))
        .wrapping_add(w(2) * x(high))
        .wrapping_add(w(3) * x(high >> 16))
}

#[inline(always)]
fn in_pairs(&[a, b, c, d]: &[i16; COLUMNS]) -> Pairs {
    let pair = |low: i16, high: i16| u32::from(low as u16) | u32::from(high as u16) << 16;
    [pair(a, b), pair(c, d)]
}
