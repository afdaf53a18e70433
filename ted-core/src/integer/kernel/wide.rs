//! The dot product on x86-64: in AVX2 where the processor has it, in plain code otherwise.

use super::{ROWS, vector};
use crate::x86::{COLUMNS, add_dot};

/// What of a layer's input fills no register, at the end of one that is zero before it.
pub(super) struct Activations {
    last: [i16; COLUMNS],
}

impl Activations {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self { last: [0; COLUMNS] }
    }

    #[inline(always)]
    pub(super) fn take(&mut self, x: &[i16]) {
        self.last = [0; COLUMNS];
        let (_, rest) = x.as_chunks::<COLUMNS>();
        for (last, x) in self.last.iter_mut().rev().zip(rest.iter().rev()) {
            *last = *x;
        }
    }

    /// Adds to each sum the dot product of its row with the input.
    #[inline(always)]
    pub(super) fn add_dot(&self, rows: &[i8], x: &[i16], sums: &mut [i32; ROWS]) {
        if !add_dot(rows, x, &self.last, sums) {
            let mut activations = vector::Activations::new();
            activations.take(x);
            activations.add_dot(rows, x, sums);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_as_long_as_a_register_are_not_left_to_plain_code_where_there_is_avx2() {
        let there = std::is_x86_feature_detected!("avx2");
        for inputs in 1..=3 * COLUMNS {
            let (rows, x) = ([1; 3 * COLUMNS * ROWS], [1; 3 * COLUMNS]);
            let (rows, x) = (&rows[..inputs * ROWS], &x[..inputs]);
            let mut activations = Activations::new();
            activations.take(x);
            let mut sums = [5; ROWS];
            let done = add_dot(rows, x, &activations.last, &mut sums);
            assert_eq!(done, there && inputs >= COLUMNS, "{inputs}");
            if done {
                assert_eq!(sums, [5 + inputs as i32; ROWS]);
            }
        }
    }
}
