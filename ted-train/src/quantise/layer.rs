//! One dense layer, from `f32` to 8-bit weights.

use ted_core::Dense;
use ted_core::integer::{IntegerDense, IntegerError, MAX_WEIGHT, bias_limit};

/// An integer layer as plain arrays.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IntegerLayer {
    inputs: usize,
    weights: Vec<i8>,
    bias: Vec<i32>,
    multipliers: Vec<i32>,
    shifts: Vec<i8>,
}

/// What a layer reads: one unit in the last place of its inputs, and each input's mean, both as real numbers.
#[derive(Clone, Copy, Debug)]
pub struct LayerInput<'a> {
    /// What an integer input of 1 stands for.
    pub unit: f64,
    /// Mean of each input over the calibration observations.
    pub mean: &'a [f64],
}

impl IntegerLayer {
    /// Quantises a layer, every output by its own scale, symmetric.
    ///
    /// The rounding of weights shifts an output by `sum((w - w_quantised) * mean(x))` on average; the bias takes that back.
    #[must_use]
    pub fn quantise(layer: &Dense<'_>, input: LayerInput<'_>, output_unit: f64) -> Self {
        let inputs = layer.inputs();
        let mut quantised = Self {
            inputs,
            weights: Vec::with_capacity(layer.weights().len()),
            bias: Vec::with_capacity(layer.outputs()),
            multipliers: Vec::with_capacity(layer.outputs()),
            shifts: Vec::with_capacity(layer.outputs()),
        };
        for (row, &bias) in layer.weights().chunks_exact(inputs).zip(layer.bias()) {
            quantised.push_output(row, f64::from(bias), input, output_unit);
        }
        quantised
    }

    fn push_output(&mut self, row: &[f32], bias: f64, input: LayerInput<'_>, output_unit: f64) {
        let limit = f64::from(bias_limit(self.inputs));
        let largest = row
            .iter()
            .fold(0.0_f64, |largest, w| largest.max(f64::from(w.abs())));
        // Half of the accumulator's room is for the correction below.
        let for_weights = largest / f64::from(MAX_WEIGHT);
        let for_bias = 2.0 * bias.abs() / (input.unit * limit);
        let unit = for_weights.max(for_bias);
        let factor = multiplier(input.unit * unit / output_unit);
        let Some((multiplier, shift)) = factor else {
            // Even the largest sum stays far below one unit in the last place.
            self.weights.extend(row.iter().map(|_| 0));
            self.bias.push(0);
            self.multipliers.push(1 << 30);
            self.shifts.push(0);
            return;
        };
        let most = f64::from(MAX_WEIGHT);
        let mut corrected = bias;
        for (&w, mean) in row.iter().zip(input.mean) {
            let exact = f64::from(w) / unit;
            let rounded = exact.round().clamp(-most, most);
            corrected += (exact - rounded) * unit * mean;
            self.weights.push(rounded as i8);
        }
        let bias = (corrected / (input.unit * unit)).round();
        self.bias.push(bias.clamp(-limit, limit) as i32);
        self.multipliers.push(multiplier);
        self.shifts.push(shift);
    }

    /// The device's view of it.
    ///
    /// # Errors
    /// When it is wider than the device's limits.
    pub fn view(&self) -> Result<IntegerDense<'_>, IntegerError> {
        IntegerDense::new(
            self.inputs,
            &self.weights,
            &self.bias,
            &self.multipliers,
            &self.shifts,
        )
    }
}

/// `factor` as `multiplier * 2^(shift - 31)` with a multiplier in [2^30, 2^31), the largest there is if that is too small;
/// nothing for a factor below 2^-32, by which no sum of 32 bits comes to a half.
fn multiplier(factor: f64) -> Option<(i32, i8)> {
    const LARGEST: (i32, i8) = (i32::MAX, 31);
    let one = 2_f64.powi(31);
    let (mantissa, mut shift) = libm::frexp(factor);
    let mut mantissa = (mantissa * one).round();
    if mantissa >= one {
        mantissa /= 2.0;
        shift += 1;
    }
    match shift {
        32.. => Some(LARGEST),
        -31..32 if factor > 0.0 => Some((mantissa as i32, shift as i8)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_factor_comes_back_within_half_a_unit_of_its_multiplier() {
        for exponent in -30..30 {
            for mantissa in [1.0, 1.000_000_000_1, 1.5, 1.999_999_999_9] {
                let factor = mantissa * 2_f64.powi(exponent);
                let (multiplier, shift) = multiplier(factor).unwrap();
                let back = f64::from(multiplier) * 2_f64.powi(i32::from(shift) - 31);
                assert!(
                    ((back - factor) / factor).abs() <= 2_f64.powi(-31),
                    "{factor}"
                );
                assert!(multiplier >= 1 << 30);
            }
        }
        for too_small in [0.0, 1e-12, f64::MIN_POSITIVE] {
            assert_eq!(multiplier(too_small), None, "{too_small}");
        }
        for too_large in [2_f64.powi(31), 1e12, f64::MAX] {
            assert_eq!(multiplier(too_large), Some((i32::MAX, 31)), "{too_large}");
        }
    }

    #[test]
    fn the_bias_takes_back_what_rounding_the_weights_does_on_average() {
        // The largest weight sets the unit to 0.01; 0.004 and 0.006 become 0 and 1 of it.
        let (weights, bias) = ([1.27, 0.004, 0.006], [0.5]);
        let layer = Dense::new(3, 1, &weights, &bias).unwrap();
        let mean = [0.0, 3.0, 5.0];
        let input = LayerInput {
            unit: 1e-3,
            mean: &mean,
        };
        let quantised = IntegerLayer::quantise(&layer, input, 1e-3);
        assert_eq!(quantised.weights, [127, 0, 1]);
        let expected: f64 = 0.5 + 0.004 * 3.0 + (0.006 - 0.01) * 5.0;
        assert_eq!(quantised.bias, [(expected / 1e-5).round() as i32]);
        assert!(quantised.view().is_ok());
    }

    #[test]
    fn an_output_of_zeros_and_a_bias_beyond_the_accumulator_are_still_layers() {
        let (weights, bias) = ([0.0, 0.0, 1e-9, 1e-9], [0.0, 1e6]);
        let layer = Dense::new(2, 2, &weights, &bias).unwrap();
        let mean = [0.0; 2];
        let input = LayerInput {
            unit: 1e-3,
            mean: &mean,
        };
        let quantised = IntegerLayer::quantise(&layer, input, 1e-3);
        assert!(quantised.view().is_ok());
        assert_eq!(quantised.weights, [0; 4]);
        // The bias has half of the accumulator's room, and its weights too little of it to be seen.
        assert_eq!(quantised.bias, [0, bias_limit(2) / 2 + 1]);
    }
}
