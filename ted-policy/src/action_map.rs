//! Between the numbers of a policy, which lie in [-1, 1], and those of a robot: one straight line for each action channel.

/// `robot = middle + half * unit`, with -1 at the low end of the channel's range and 1 at the high end. For the range [-1, 1] it
/// changes no number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActionMap {
    middle: f32,
    half: f32,
}

impl ActionMap {
    /// The map of a channel with this range, which is ordered and of finite width.
    #[must_use]
    pub const fn new(low: f32, high: f32) -> Self {
        let half = 0.5 * (high - low);
        Self {
            middle: low + half,
            half,
        }
    }

    /// The middle of the range, which is the policy's 0.
    #[must_use]
    pub const fn middle(self) -> f32 {
        self.middle
    }

    /// Half the width of the range, which is the policy's 1.
    #[must_use]
    pub const fn half(self) -> f32 {
        self.half
    }

    /// What the policy's number is to the robot, in the channel's unit.
    #[inline]
    #[must_use]
    pub fn robot(self, unit: f32) -> f32 {
        self.middle + self.half * unit
    }

    /// What the robot's number, in the channel's unit, is to the policy: in [-1, 1] for one inside the range, up to a rounding.
    #[inline]
    #[must_use]
    pub fn unit(self, robot: f32) -> f32 {
        (robot - self.middle) / self.half
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RANGES: [(f32, f32); 5] = [
        (-1.0, 1.0),
        (0.0, 1.0),
        (-0.4, 0.4),
        (-3.0, 250.0),
        (1e-6, 2e-6),
    ];

    #[test]
    fn the_ends_of_a_range_are_minus_one_and_one() {
        for (low, high) in RANGES {
            let map = ActionMap::new(low, high);
            let allowed = 4.0 * f32::EPSILON * (1.0 + map.middle.abs() / map.half);
            for (end, unit) in [(low, -1.0), (high, 1.0)] {
                assert!((map.unit(end) - unit).abs() <= allowed, "{low} {high}");
            }
            let wide = f64::from(high) - f64::from(low);
            for (unit, end) in [(-1.0, low), (1.0, high)] {
                let off = f64::from(map.robot(unit)) - f64::from(end);
                assert!(off.abs() <= f64::from(allowed) * wide, "{low} {high} {off}");
            }
        }
    }

    #[test]
    fn there_and_back_costs_a_rounding() {
        for (low, high) in RANGES {
            let map = ActionMap::new(low, high);
            // Rounding in the robot's unit is as large as its numbers, which may be large beside its range.
            let allowed = 4.0 * f32::EPSILON * (1.0 + map.middle.abs() / map.half);
            for step in -100..=100_i8 {
                let unit = f32::from(step) / 100.0;
                let back = map.unit(map.robot(unit));
                assert!((back - unit).abs() <= allowed, "{low} {high} {unit} {back}");
            }
        }
    }

    #[test]
    fn the_range_from_minus_one_to_one_changes_no_number() {
        let map = ActionMap::new(-1.0, 1.0);
        for step in -1000..=1000_i16 {
            let unit = f32::from(step) / 1001.0;
            assert_eq!((map.robot(unit), map.unit(unit)), (unit, unit));
        }
    }
}
