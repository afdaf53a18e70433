//! From an accumulator to the next activation: one multiplication and one rounding.

use super::dense::MAX_ACTIVATION;

/// `floor(acc * multiplier * 2^(shift - 31) + 1/2)`, saturated to the symmetric range of an activation.
///
/// The rule is pinned: one rounding, halves towards positive infinity. Two roundings, as CMSIS-NN and TFLite do by default,
/// give another last bit on some halves. [`super::IntegerDense`] has proved that `multiplier` is below 2^31 and `shift` in
/// [-31, 31], so that neither the product nor the half added to it leaves an `i64`.
#[inline(always)]
pub(super) fn requantise(acc: i32, multiplier: i32, shift: i8) -> i16 {
    let to_the_right = 31_u32.saturating_add_signed(-i32::from(shift)).min(62);
    let half = (1_i64 << to_the_right) >> 1;
    let product = i64::from(acc) * i64::from(multiplier);
    let rounded = product.wrapping_add(half) >> to_the_right;
    let limit = i64::from(MAX_ACTIVATION);
    if rounded > limit {
        MAX_ACTIVATION
    } else if rounded < -limit {
        -MAX_ACTIVATION
    } else {
        rounded as i16
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ONE_HALF: i32 = 1 << 30;

    #[test]
    fn halves_are_rounded_towards_positive_infinity() {
        // acc / 2: one bit is lost, so every odd number is a half.
        for (acc, expected) in [(1, 1), (3, 2), (-1, 0), (-3, -1), (4, 2), (-4, -2), (0, 0)] {
            assert_eq!(requantise(acc, ONE_HALF, 0), expected, "{acc}");
        }
    }

    #[test]
    fn the_ends_saturate_and_nothing_overflows() {
        for shift in [-31, -30, -1, 0, 1, 30, 31] {
            for multiplier in [ONE_HALF, i32::MAX] {
                for acc in [i32::MIN, i32::MIN + 1, -1, 0, 1, i32::MAX - 1, i32::MAX] {
                    let exact = i128::from(acc) * i128::from(multiplier);
                    let right = (31 - i32::from(shift)) as u32;
                    let rounded = (exact + ((1_i128 << right) >> 1)) >> right;
                    let limit = i128::from(MAX_ACTIVATION);
                    let expected = rounded.clamp(-limit, limit);
                    let computed = requantise(acc, multiplier, shift);
                    assert_eq!(i128::from(computed), expected, "{acc} {multiplier} {shift}");
                }
            }
        }
    }
}
