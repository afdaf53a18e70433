//! The same policy in integers: 8-bit weights with one step for each output, fixed point everywhere else.
//!
//! Only what a timing needs: the trainer's export has the quantiser that policies fly with.

use ted_core::integer::{IntegerDense, IntegerError, MAX_WEIGHT};

use crate::network::{Layer, Network};

/// Fraction bits of the standardised observation, which lies in [-4, 4].
const INPUT_FRACTION_BITS: u8 = 12;

/// Fraction bits of the hidden activations and of the last layer before its tanh.
const FRACTION_BITS: u8 = 11;

/// Parameters of the integer layers, owned.
pub struct Quantised {
    layers: Vec<Parameters>,
    pub input_fraction_bits: u8,
    pub output_fraction_bits: u8,
}

struct Parameters {
    inputs: usize,
    weights: Vec<i8>,
    bias: Vec<i32>,
    multipliers: Vec<i32>,
    shifts: Vec<i8>,
}

impl Quantised {
    pub fn new(network: &Network) -> Self {
        let layers = network.layers.iter().enumerate().map(|(index, layer)| {
            let read = match index {
                0 => INPUT_FRACTION_BITS,
                _ => FRACTION_BITS,
            };
            Parameters::new(layer, read, FRACTION_BITS)
        });
        Self {
            layers: layers.collect(),
            input_fraction_bits: INPUT_FRACTION_BITS,
            output_fraction_bits: FRACTION_BITS,
        }
    }

    /// The layers as ted-core borrows them.
    pub fn views(&self) -> Result<Vec<IntegerDense<'_>>, IntegerError> {
        self.layers
            .iter()
            .map(|p| IntegerDense::new(p.inputs, &p.weights, &p.bias, &p.multipliers, &p.shifts))
            .collect()
    }
}

impl Parameters {
    /// Each output has its own step, the largest weight over 127.
    fn new(layer: &Layer, read: u8, write: u8) -> Self {
        let mut parameters = Self {
            inputs: layer.inputs,
            weights: Vec::new(),
            bias: Vec::new(),
            multipliers: Vec::new(),
            shifts: Vec::new(),
        };
        for (row, bias) in layer.weights.chunks(layer.inputs).zip(&layer.bias) {
            let largest = row.iter().fold(f32::MIN_POSITIVE, |m, w| m.max(w.abs()));
            let step = f64::from(largest) / f64::from(MAX_WEIGHT);
            let whole = |v: f64| v.round();
            parameters
                .weights
                .extend(row.iter().map(|&w| whole(f64::from(w) / step) as i8));
            let one = f64::from(1_u32 << read);
            parameters
                .bias
                .push(whole(f64::from(*bias) / step * one) as i32);
            // step * 2^(write - read) = multiplier / 2^31 * 2^shift, multiplier in [2^30, 2^31)
            let factor = step * f64::from(1_u32 << write) / one;
            let shift = factor.log2().floor() as i32 + 1;
            parameters
                .multipliers
                .push((factor * 2_f64.powi(31 - shift)) as i32);
            parameters.shifts.push(shift as i8);
        }
        parameters
    }
}
