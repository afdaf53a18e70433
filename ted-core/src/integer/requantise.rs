//! From an accumulator to the next activation: one multiplication and one rounding.

use super::dense::MAX_ACTIVATION;

/// `floor(acc * multiplier * 2^(shift - 31) + 1/2)`, saturated to `least..=MAX_ACTIVATION`.
///
/// The rule is pinned: one rounding, halves towards positive infinity. Two roundings, as CMSIS-NN and TFLite do by default,
/// give another last bit on some halves. [`super::IntegerDense`] has proved that `multiplier` is below 2^31 and `shift` in
/// [-31, 31], so that neither the product nor the half added to it leaves an `i64`.
#[inline(always)]
pub(super) fn requantise(acc: i32, multiplier: i32, shift: i8, least: i16) -> i16 {
    let to_the_right = 31 - i32::from(shift);
    let product = i64::from(acc) * i64::from(multiplier);
    let rounded = if to_the_right > 32 {
        // Half a unit and what is above it lie in the high word, which is all that a 32-bit machine then has to look at.
        let halves = ((product >> 32) as i32).wrapping_shr((to_the_right - 33) as u32);
        (halves + 1) >> 1
    } else {
        round_in_the_low_word(product, to_the_right)
    };
    rounded.max(i32::from(least)).min(i32::from(MAX_ACTIVATION)) as i16
}

/// Out of line, because few layers need it. Saturates to an `i32`.
#[cold]
#[inline(never)]
fn round_in_the_low_word(product: i64, to_the_right: i32) -> i32 {
    let to_the_right = to_the_right.clamp(0, 32);
    let half = (1_i64 << to_the_right) >> 1;
    let rounded = (product + half) >> to_the_right;
    rounded.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    const ONE_HALF: i32 = 1 << 30;

    #[test]
    fn halves_are_rounded_towards_positive_infinity() {
        // acc / 2: one bit is lost, so every odd number is a half.
        for (acc, expected) in [(1, 1), (3, 2), (-1, 0), (-3, -1), (4, 2), (-4, -2), (0, 0)] {
            assert_eq!(
                requantise(acc, ONE_HALF, 0, -MAX_ACTIVATION),
                expected,
                "{acc}"
            );
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
                    let computed = requantise(acc, multiplier, shift, -MAX_ACTIVATION);
                    assert_eq!(i128::from(computed), expected, "{acc} {multiplier} {shift}");
                }
            }
        }
    }
}
