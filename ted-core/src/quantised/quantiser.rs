//! From a raw value to a standardised one in 16-bit fixed point.

use crate::error::{Part, ShapeError};
use crate::integer::MAX_ACTIVATION;
use crate::normaliser::Normaliser;

/// `floor(norm * 2^fraction_bits + 1/2)`, saturated to [`MAX_ACTIVATION`]; NaN becomes 0.
#[must_use]
pub fn fixed(norm: f32, fraction_bits: u8) -> i16 {
    let limit = f32::from(MAX_ACTIVATION);
    let scaled = norm * one(fraction_bits);
    if scaled >= limit {
        MAX_ACTIVATION
    } else if scaled <= -limit {
        -MAX_ACTIVATION
    } else {
        // Whole and fraction are exact: both fit the 24 bits of an `f32` many times over.
        let towards_zero = scaled as i16;
        let whole = towards_zero - i16::from(scaled < f32::from(towards_zero));
        whole + i16::from(scaled - f32::from(whole) >= 0.5)
    }
}

/// What one unit in the last place of a quantised channel means in the channel's raw unit.
#[must_use]
pub fn resolution(scale: f32, fraction_bits: u8) -> f32 {
    1.0 / (scale * one(fraction_bits))
}

/// The number in floats that one is in fixed point.
pub(super) fn one(fraction_bits: u8) -> f32 {
    (1_u32 << fraction_bits.min(31)) as f32
}

/// Standardises and quantises `parts`, one after the other, into `out`.
pub(super) fn quantise(
    parts: [&[f32]; 2],
    normaliser: &Normaliser<'_>,
    fraction_bits: u8,
    out: &mut [i16],
) -> Result<(), ShapeError> {
    let actual = parts.iter().map(|part| part.len()).sum();
    ShapeError::same(Part::Input, normaliser.channels(), actual)?;
    ShapeError::same(Part::Input, normaliser.channels(), out.len())?;
    let statistics = normaliser.shift().iter().zip(normaliser.scale());
    let mut channels = out.iter_mut().zip(statistics);
    for part in parts {
        quantise_part(part, &mut channels, fraction_bits);
    }
    Ok(())
}

/// Once in an image and not once for each part.
#[inline(never)]
fn quantise_part<'a>(
    part: &[f32],
    channels: &mut impl Iterator<Item = (&'a mut i16, (&'a f32, &'a f32))>,
    fraction_bits: u8,
) {
    for (raw, (out, (shift, scale))) in part.iter().zip(channels) {
        *out = fixed((raw - shift) * scale, fraction_bits);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_go_up_and_nothing_else_does() {
        let cases = [
            (0.5, 1),
            (0.499_999_97, 0),
            (-0.5, 0),
            (-0.500_000_06, -1),
            (1.5, 2),
            (-1.5, -1),
            (2.4, 2),
            (-2.6, -3),
            (-0.0, 0),
        ];
        for (v, expected) in cases {
            assert_eq!(fixed(v, 0), expected, "{v}");
            assert_eq!(fixed(v / 4096.0, 12), expected, "{v} / 4096");
        }
    }

    #[test]
    fn the_rule_holds_in_wider_arithmetic_for_every_exponent() {
        for bits in (0..u32::MAX).step_by(9973) {
            let v = f32::from_bits(bits);
            let exact = (f64::from(v) * 4096.0 + 0.5)
                .floor()
                .clamp(-32767.0, 32767.0);
            let expected = if v.is_nan() { 0.0 } else { exact };
            assert_eq!(f64::from(fixed(v, 12)), expected, "{v:e}");
        }
    }

    #[test]
    fn another_number_of_values_is_refused() {
        let normaliser = Normaliser::new(&[0.0; 3], &[1.0; 3]).unwrap();
        let mut out = [0; 3];
        assert!(quantise([&[0.0; 2], &[0.0]], &normaliser, 12, &mut out).is_ok());
        assert!(quantise([&[0.0; 2], &[]], &normaliser, 12, &mut out).is_err());
        assert!(quantise([&[0.0; 2], &[0.0]], &normaliser, 12, &mut out[..2]).is_err());
    }
}
