//! The dense kernel: several output rows at once, each summed in four lanes.
//!
//! The order of every addition is fixed (see [`crate::reference`], which is the definition), so how many rows or samples
//! are computed together changes the speed and never a bit. Nothing here can panic: rows are cut with checked splits, and
//! a row that is missing ends the loop. [`crate::Dense`] has proved that none is.

/// Partial sums of one output row.
type Lanes = [f32; LANES];

const LANES: usize = 4;

/// Computes `out[s][o] = activate(sum_i w[o][i] * x[s][i] + bias[o])` for `S` samples, `R` rows at a time.
#[inline(always)]
pub(crate) fn dense<const R: usize, const S: usize>(
    weights: &[f32],
    bias: &[f32],
    xs: [&[f32]; S],
    outs: [&mut [f32]; S],
    activate: impl Fn(f32) -> f32,
) {
    let inputs = xs.iter().map(|x| x.len()).min().unwrap_or(0);
    let mut rows = Rows {
        rest: weights,
        inputs,
    };
    let mut outs = outs.map(|out| out.iter_mut());
    let (groups, remainder) = bias.as_chunks::<R>();
    for group in groups {
        let Some(weights) = rows.take::<R>() else {
            return;
        };
        for (sums, bias) in tile(weights, xs).into_iter().zip(group) {
            store(&mut outs, sums, *bias, &activate);
        }
    }
    for bias in remainder {
        let Some(weights) = rows.take::<1>() else {
            return;
        };
        for sums in tile(weights, xs) {
            store(&mut outs, sums, *bias, &activate);
        }
    }
}

/// Writes one output row of every sample.
#[inline(always)]
fn store<const S: usize>(
    outs: &mut [core::slice::IterMut<'_, f32>; S],
    sums: [f32; S],
    bias: f32,
    activate: &impl Fn(f32) -> f32,
) {
    for (out, sum) in outs.iter_mut().zip(sums) {
        if let Some(out) = out.next() {
            *out = activate(sum + bias);
        }
    }
}

/// Dot products of `R` rows with `S` samples.
#[inline(always)]
fn tile<const R: usize, const S: usize>(rows: [&[f32]; R], xs: [&[f32]; S]) -> [[f32; S]; R] {
    let rows = rows.map(|row| row.as_chunks::<LANES>());
    let xs = xs.map(|x| x.as_chunks::<LANES>());
    let mut sums = [[[0.0; LANES]; S]; R];
    let blocks = xs.iter().map(|x| x.0.len()).min().unwrap_or(0);
    for k in 0..blocks {
        for (sums, row) in sums.iter_mut().zip(&rows) {
            let Some(w) = row.0.get(k) else { break };
            for (sum, x) in sums.iter_mut().zip(&xs) {
                let Some(x) = x.0.get(k) else { break };
                accumulate(sum, w, x);
            }
        }
    }
    // A lane starts at +0 and so never holds -0: adding the product of two padding zeros leaves its bits alone.
    for (sums, row) in sums.iter_mut().zip(&rows) {
        let w = padded(row.1);
        for (sum, x) in sums.iter_mut().zip(&xs) {
            accumulate(sum, &w, &padded(x.1));
        }
    }
    sums.map(|sums| sums.map(|[a, b, c, d]| (a + b) + (c + d)))
}

#[inline(always)]
fn accumulate(sum: &mut Lanes, w: &Lanes, x: &Lanes) {
    for ((sum, w), x) in sum.iter_mut().zip(w).zip(x) {
        *sum += w * x;
    }
}

#[inline(always)]
fn padded(tail: &[f32]) -> Lanes {
    let mut lanes = [0.0; LANES];
    for (lane, value) in lanes.iter_mut().zip(tail) {
        *lane = *value;
    }
    lanes
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
