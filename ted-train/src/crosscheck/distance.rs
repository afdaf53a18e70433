//! How far two sequences of numbers are apart: absolute, and in units in the last place.

use serde::Serialize;

/// Largest and mean difference of pairs of numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Distance {
    /// Pairs compared.
    pub compared: u64,
    /// Pairs whose bits differ.
    pub unequal: u64,
    /// Largest absolute difference; infinite when one side is not a number.
    pub max_absolute: f64,
    /// Mean absolute difference.
    pub mean_absolute: f64,
    /// Largest difference in units in the last place.
    pub max_ulp: u32,
    /// Mean difference in units in the last place.
    pub mean_ulp: f64,
}

impl Distance {
    /// Compares two sequences of equal length.
    #[must_use]
    pub fn between(left: &[f32], right: &[f32]) -> Self {
        let mut all = Self::default();
        for (&left, &right) in left.iter().zip(right) {
            let absolute = (f64::from(left) - f64::from(right)).abs();
            let absolute = if absolute.is_nan() {
                f64::INFINITY
            } else {
                absolute
            };
            let ulp = ulp(left, right);
            all.compared += 1;
            all.unequal += u64::from(left.to_bits() != right.to_bits());
            all.max_absolute = all.max_absolute.max(absolute);
            all.mean_absolute += absolute;
            all.max_ulp = all.max_ulp.max(ulp);
            all.mean_ulp += f64::from(ulp);
        }
        let count = all.compared.max(1) as f64;
        all.mean_absolute /= count;
        all.mean_ulp /= count;
        all
    }

    /// Both comparisons as one.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        let compared = self.compared + other.compared;
        let mean = |mine: f64, others: f64| {
            let sum = mine * self.compared as f64 + others * other.compared as f64;
            sum / compared.max(1) as f64
        };
        Self {
            compared,
            unequal: self.unequal + other.unequal,
            max_absolute: self.max_absolute.max(other.max_absolute),
            mean_absolute: mean(self.mean_absolute, other.mean_absolute),
            max_ulp: self.max_ulp.max(other.max_ulp),
            mean_ulp: mean(self.mean_ulp, other.mean_ulp),
        }
    }
}

/// How many representable numbers the second is away from the first; the most there is when one is not a number.
#[must_use]
pub fn ulp(left: f32, right: f32) -> u32 {
    if left.is_nan() || right.is_nan() {
        return u32::MAX;
    }
    // As integers, positive floats are in order and negative ones in reverse order; both zeros are 0.
    let place = |x: f32| {
        let magnitude = i64::from(x.to_bits() & 0x7fff_ffff);
        if x.is_sign_negative() {
            -magnitude
        } else {
            magnitude
        }
    };
    u32::try_from((place(left) - place(right)).unsigned_abs()).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_are_one_unit_apart_on_both_sides_of_zero() {
        for x in [1.0, -1.0, 1e-40, f32::MIN_POSITIVE, 0.0] {
            assert_eq!(ulp(x, x), 0);
            assert_eq!(ulp(x, x.next_up()), 1, "{x}");
            assert_eq!(ulp(x.next_down(), x), 1, "{x}");
        }
        let tiny = f32::from_bits(1);
        assert_eq!((ulp(0.0, -0.0), ulp(tiny, -tiny)), (0, 2));
        assert_eq!(ulp(1.0, 2.0), 1 << 23);
        assert_eq!(ulp(f32::MAX, f32::MIN), 2 * 0x7f7f_ffff);
    }

    #[test]
    fn what_is_not_a_number_is_as_far_away_as_can_be() {
        assert_eq!(ulp(f32::NAN, 1.0), u32::MAX);
        let distance = Distance::between(&[f32::NAN, 1.0], &[1.0, 1.0]);
        assert_eq!(
            (distance.max_absolute, distance.unequal),
            (f64::INFINITY, 1)
        );
    }

    #[test]
    fn two_parts_together_are_the_whole() {
        let (left, right) = ([1.0, 2.0, 3.0, 4.0], [1.5, 2.0, 3.0, 3.0]);
        let whole = Distance::between(&left, &right);
        let parts = Distance::between(&left[..1], &right[..1])
            .and(Distance::between(&left[1..], &right[1..]));
        assert_eq!(whole, parts);
        assert_eq!((whole.compared, whole.unequal), (4, 2));
        assert_eq!((whole.max_absolute, whole.mean_absolute), (1.0, 0.375));
    }
}
