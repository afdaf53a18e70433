//! Activations, with the same bits on every machine.

/// `v` where it is positive, otherwise positive zero (also for NaN and negative zero).
#[inline]
#[must_use]
pub fn relu(v: f32) -> f32 {
    if v > 0.0 { v } else { 0.0 }
}

/// Hyperbolic tangent from `libm`, never from the platform, whose last bits differ between systems.
///
/// Within 2.5 units in the last place of the exact value (largest seen: 2.17).
#[inline]
#[must_use]
pub fn tanh(v: f32) -> f32 {
    libm::tanhf(v)
}

/// What a layer does with its sums.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Activation {
    /// [`relu`].
    Relu,
    /// Nothing.
    Linear,
    /// [`tanh`].
    Tanh,
}

impl Activation {
    /// Activates all of `values`, one kind in one loop.
    #[inline(always)]
    pub(crate) fn apply(self, values: &mut [f32]) {
        match self {
            Self::Relu => values.iter_mut().for_each(|v| *v = relu(*v)),
            Self::Linear => {}
            Self::Tanh => values.iter_mut().for_each(|v| *v = tanh(*v)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn relu_keeps_positive_numbers_and_turns_everything_else_into_positive_zero() {
        assert_eq!(relu(2.5), 2.5);
        for v in [-1.0, -0.0, 0.0, f32::NAN, f32::NEG_INFINITY] {
            assert_eq!(relu(v).to_bits(), 0.0_f32.to_bits(), "{v}");
        }
    }

    #[test]
    fn tanh_has_these_bits_on_every_machine() {
        let cases = [
            (0.0, 0x0000_0000),
            (-0.0, 0x8000_0000),
            (0.5, 0x3eec_9a9e),
            (-1.0, 0xbf42_f7d6),
            (3.0, 0x3f7e_bbe9),
            (40.0, 0x3f80_0000),
        ];
        for (v, bits) in cases {
            assert_eq!(
                tanh(v).to_bits(),
                bits,
                "tanh({v}) = {:08x}",
                tanh(v).to_bits()
            );
        }
    }

    #[test]
    fn tanh_is_odd_and_within_two_and_a_half_units_in_the_last_place() {
        for step in 0..200_000_u32 {
            let v = step as f32 * 5e-5;
            let (exact, computed) = (f64::from(v).tanh(), tanh(v));
            let ulp = f64::from(computed.next_up()) - f64::from(computed);
            assert!(
                (f64::from(computed) - exact).abs() <= 2.5 * ulp,
                "tanh({v})"
            );
            assert_eq!(tanh(-v).to_bits(), (-computed).to_bits());
        }
    }
}
