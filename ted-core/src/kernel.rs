//! The dense kernel: several output rows at once, each summed in four lanes.
//!
//! The order of every addition is fixed (see [`crate::reference`], which is the definition), so how many rows are computed
//! together changes the speed and never a bit. Nothing here can panic: rows are cut with checked splits, and a row that is
//! missing ends the loop. [`crate::Dense`] has proved that none is.

/// Partial sums of one output row.
type Lanes = [f32; LANES];

const LANES: usize = 4;

/// Rows computed together: four rows of four lanes fit the registers of a Cortex-M4F and of SSE2.
const ROWS: usize = 4;

/// Computes `out[o] = sum_i weights[o][i] * x[i] + bias[o]`.
///
/// Out of line: hidden and last layers of all networks share the one copy there is.
#[inline(never)]
pub(crate) fn dense(weights: &[f32], bias: &[f32], x: &[f32], out: &mut [f32]) {
    #[cfg(target_arch = "x86_64")]
    let (weights, bias, out) = {
        let rows = crate::x86::sums(weights, bias, x, out);
        let rest = (
            weights.get(rows * x.len()..),
            bias.get(rows..),
            out.get_mut(rows..),
        );
        let (Some(weights), Some(bias), Some(out)) = rest else {
            return;
        };
        (weights, bias, out)
    };
    portable(weights, bias, x, out);
}

/// The same on any machine.
#[inline(always)]
fn portable(weights: &[f32], bias: &[f32], x: &[f32], out: &mut [f32]) {
    let mut rows = Rows {
        rest: weights,
        inputs: x.len(),
    };
    let (groups, odd_bias) = bias.as_chunks::<ROWS>();
    let (out_groups, odd_out) = out.as_chunks_mut::<ROWS>();
    for (bias, out) in groups.iter().zip(out_groups) {
        let Some(weights) = rows.take::<ROWS>() else {
            return;
        };
        for ((out, sum), bias) in out.iter_mut().zip(dot(weights, x)).zip(bias) {
            *out = sum + bias;
        }
    }
    for (bias, out) in odd_bias.iter().zip(odd_out) {
        let Some(weights) = rows.take::<1>() else {
            return;
        };
        for sum in dot(weights, x) {
            *out = sum + bias;
        }
    }
}

/// Dot products of `R` rows with `x`.
#[inline(always)]
fn dot<const R: usize>(rows: [&[f32]; R], x: &[f32]) -> [f32; R] {
    let rows = rows.map(|row| row.as_chunks::<LANES>());
    let (blocks, tail) = x.as_chunks::<LANES>();
    let mut sums = dot_blocks(rows.map(|row| row.0), blocks);
    for (sum, row) in sums.iter_mut().zip(&rows) {
        for ((lane, w), x) in sum.iter_mut().zip(row.1).zip(tail) {
            *lane += w * x;
        }
    }
    sums.map(|[a, b, c, d]| (a + b) + (c + d))
}

/// The part of the dot products that fills all four lanes.
///
/// Out of line on purpose: the lanes then leave through memory, four in a row, which is what tells the compiler to keep
/// each sum in one vector register. Inlined, it pairs lanes of different rows and shuffles in the inner loop.
#[inline(never)]
fn dot_blocks<const R: usize>(rows: [&[Lanes]; R], x: &[Lanes]) -> [Lanes; R] {
    let mut sums = [[0.0; LANES]; R];
    #[cfg(all(target_arch = "arm", target_abi = "eabihf", feature = "cortex-m"))]
    if let (&[a, b, c, d], Ok(sums_of_four)) = (&rows[..], (&mut sums[..]).try_into()) {
        crate::cortex_m::add_dot_f32([a, b, c, d], x, sums_of_four);
        return sums;
    }
    // Rows as long as `x`, said so that the compiler sees it and drops every other check from the loop.
    let count = x.len();
    if rows.iter().any(|row| row.len() != count) {
        return sums;
    }
    let mut k = 0;
    while k < count {
        let Some(x) = x.get(k) else { break };
        for (sum, row) in sums.iter_mut().zip(&rows) {
            let Some(w) = row.get(k) else { break };
            for ((lane, w), x) in sum.iter_mut().zip(w).zip(x) {
                *lane += w * x;
            }
        }
        k += 1;
    }
    sums
}

/// The rows of a row-major matrix that were not taken yet.
struct Rows<'a> {
    rest: &'a [f32],
    inputs: usize,
}

impl<'a> Rows<'a> {
    #[inline(always)]
    fn take<const R: usize>(&mut self) -> Option<[&'a [f32]; R]> {
        let mut rows = [&[][..]; R];
        for row in &mut rows {
            (*row, self.rest) = self.rest.split_at_checked(self.inputs)?;
        }
        Some(rows)
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::*;
    use crate::reference;

    #[test]
    fn what_runs_on_any_machine_has_the_bits_of_the_reference_for_every_small_shape() {
        for inputs in 1..=20 {
            for outputs in 1..=20 {
                let number = |i: usize| {
                    ((i as u32).wrapping_mul(2_654_435_761) >> 8) as f32 / (1 << 23) as f32 - 1.0
                };
                let weights: Vec<f32> = (0..inputs * outputs).map(|i| number(7 * i)).collect();
                let x: Vec<f32> = (0..inputs).map(number).collect();
                let bias: Vec<f32> = (0..outputs).map(|o| number(3 * o)).collect();
                let mut out: Vec<f32> = (0..outputs).map(|_| f32::NAN).collect();
                portable(&weights, &bias, &x, &mut out);
                let rows = weights.chunks(inputs).zip(&bias);
                let expected = rows.map(|(row, bias)| reference::dense_row(row, *bias, &x));
                for (o, (out, expected)) in out.iter().zip(expected).enumerate() {
                    assert_eq!(out.to_bits(), expected.to_bits(), "{inputs} {o}");
                }
            }
        }
    }
}
