//! The definition of a dense layer's bits, in the plainest code there is.
//!
//! Four lanes: lane `l` starts at zero and adds `w[o][i] * x[i]` for `i = l, l + 4, l + 8, ...`, product and sum rounded
//! separately (no fused multiply-add). The row is `(lane 0 + lane 1) + (lane 2 + lane 3)`, then `+ bias[o]`. The fast
//! kernel is tested against this function bit for bit.

/// Computes one output of a dense layer before its activation: `row . x + bias`.
///
/// Elements that only one of `row` and `x` has are ignored.
#[must_use]
pub fn dense_row(row: &[f32], bias: f32, x: &[f32]) -> f32 {
    let lane = |l: usize| {
        let mut sum = 0.0_f32;
        for (w, x) in row.iter().zip(x).skip(l).step_by(4) {
            sum += w * x;
        }
        sum
    };
    (lane(0) + lane(1)) + (lane(2) + lane(3)) + bias
}
