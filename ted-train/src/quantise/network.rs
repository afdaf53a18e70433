//! One network, layer by layer: what its activations need, what it becomes, and how far that is from what it was.

use serde::Serialize;
use ted_core::integer::{
    IntegerError, IntegerMlp, IntegerScratch, MAX_ACTIVATION, MAX_FRACTION_BITS, Q15,
};
use ted_core::quantised::fixed;
use ted_core::{MAX_WIDTH, Mlp, Normaliser, Output, Scratch, ShapeError};

use super::layer::{IntegerLayer, LayerInput};

/// Room above the largest activation of the calibration, for observations that it did not hold. One bit of fifteen.
const HEADROOM: f64 = 2.0;

/// Fewest fraction bits of an input: Meta-World's positions deviate by less than 0.1 m, so that a unit in the last place stays
/// below 0.1 mm. Inputs beyond 32 deviations saturate then.
const MIN_INPUT_FRACTION_BITS: u8 = 10;

/// Fraction bits before a tanh, whose table ends at 8.
const BEFORE_TANH: u8 = 12;

/// A network in integers as plain arrays.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct QuantisedNetwork {
    layers: Vec<IntegerLayer>,
    output: Output,
    /// Fraction bits of a standardised input.
    pub input_fraction_bits: u8,
    /// Fraction bits of the last layer before its activation.
    pub output_fraction_bits: u8,
}

/// How a network's integers differ from its floats on the calibration inputs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NetworkReport {
    /// How many inputs were looked at.
    pub inputs: usize,
    /// Input values that were cut off at the ends of 16 bits.
    pub saturated_inputs: usize,
    /// Its layers, first to last: hidden ones after their ReLU, the last one before its activation.
    pub layers: Vec<LayerReport>,
}

/// How a layer's integers differ from its floats.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LayerReport {
    /// Values that were cut off at the ends of 16 bits.
    pub saturated: usize,
    /// Root mean square of the difference, relative to that of the value.
    pub relative_error: f64,
}

/// Fraction bits for standardised inputs of which none exceeds `largest`, see [`MIN_INPUT_FRACTION_BITS`].
#[must_use]
pub fn input_fraction_bits(largest: f64) -> u8 {
    fraction_bits(largest).max(MIN_INPUT_FRACTION_BITS)
}

/// Fraction bits of a network's last layer before its activation.
///
/// # Errors
/// When the inputs do not fit the network.
pub fn output_fraction_bits(
    mlp: &Mlp<'_>,
    calibration: &Calibration<'_>,
) -> Result<u8, ShapeError> {
    match mlp.output() {
        Output::Tanh => Ok(BEFORE_TANH),
        Output::Linear => {
            let outputs = calibration.through(mlp, mlp.layers().count())?;
            Ok(fraction_bits(HEADROOM * largest(&outputs)))
        }
    }
}

/// Standardised inputs: those that a network is calibrated on and compared by.
pub struct Calibration<'a> {
    normaliser: Normaliser<'a>,
    norm: Vec<f32>,
}

impl<'a> Calibration<'a> {
    /// Standardises raw inputs, one after the other.
    ///
    /// # Errors
    /// When they are not whole rows of the normaliser's width.
    pub fn new(normaliser: Normaliser<'a>, mut raw: Vec<f32>) -> Result<Self, ShapeError> {
        for row in raw.chunks_mut(normaliser.channels()) {
            normaliser.apply(row)?;
        }
        Ok(Self {
            normaliser,
            norm: raw,
        })
    }

    fn rows(&self) -> impl Iterator<Item = &[f32]> {
        self.norm.chunks_exact(self.normaliser.channels())
    }

    /// Every row through the first layers of a network, before the activation of the last of them.
    fn through(&self, mlp: &Mlp<'_>, layers: usize) -> Result<Vec<f32>, ShapeError> {
        let layers: Vec<_> = mlp.layers().take(layers).copied().collect();
        let network = Mlp::new(&layers, Output::Linear)?;
        let mut scratch = Scratch::new();
        let mut all = Vec::new();
        let mut out = vec![0.0; network.outputs()];
        for row in self.rows() {
            network.forward(row, &mut scratch, &mut out)?;
            all.extend_from_slice(&out);
        }
        Ok(all)
    }
}

impl QuantisedNetwork {
    /// Quantises a network by what its activations are on the calibration inputs.
    ///
    /// # Errors
    /// When the inputs do not fit it.
    pub fn quantise(
        mlp: &Mlp<'_>,
        calibration: &Calibration<'_>,
        input_fraction_bits: u8,
        output_fraction_bits: u8,
    ) -> Result<Self, ShapeError> {
        let count = mlp.layers().count();
        let mut mean = means(&calibration.norm, mlp.inputs());
        let mut unit = 1.0 / one(input_fraction_bits);
        let mut layers = Vec::with_capacity(count);
        for (index, layer) in mlp.layers().enumerate() {
            let mut values = calibration.through(mlp, index + 1)?;
            let output_unit = if index + 1 == count {
                1.0 / one(output_fraction_bits)
            } else {
                values.iter_mut().for_each(|v| *v = v.max(0.0));
                // A layer that is never active needs some unit.
                (HEADROOM * largest(&values)).max(1e-3) / f64::from(MAX_ACTIVATION)
            };
            let input = LayerInput { unit, mean: &mean };
            layers.push(IntegerLayer::quantise(layer, input, output_unit));
            mean = means(&values, layer.outputs());
            unit = output_unit;
        }
        Ok(Self {
            layers,
            output: mlp.output(),
            input_fraction_bits,
            output_fraction_bits,
        })
    }

    /// The device's view of it.
    ///
    /// # Errors
    /// When it is larger than the device's limits.
    pub fn view(&self) -> Result<IntegerMlp<'_>, IntegerError> {
        self.prefix(self.layers.len(), self.output)
    }

    /// Compares every layer with the floats on the calibration inputs.
    ///
    /// # Errors
    /// When the inputs do not fit it.
    pub fn compare(
        &self,
        mlp: &Mlp<'_>,
        calibration: &Calibration<'_>,
    ) -> Result<NetworkReport, IntegerError> {
        let inputs: Vec<i16> = (calibration.norm.iter())
            .map(|&norm| fixed(norm, self.input_fraction_bits))
            .collect();
        let mut report = NetworkReport {
            inputs: calibration.rows().count(),
            saturated_inputs: saturated(&inputs),
            layers: Vec::new(),
        };
        for count in 1..=self.layers.len() {
            let mut exact = calibration.through(mlp, count)?;
            let network = self.prefix(count, Output::Linear)?;
            let mut scratch = IntegerScratch::new();
            let mut out = [0; MAX_WIDTH];
            let out = &mut out[..network.outputs()];
            let mut all = Vec::with_capacity(exact.len());
            for row in inputs.chunks_exact(network.inputs()) {
                network.forward(row, Q15, &mut scratch, out)?;
                all.extend_from_slice(out);
            }
            if count < self.layers.len() {
                exact.iter_mut().for_each(|v| *v = v.max(0.0));
                all.iter_mut().for_each(|q| *q = (*q).max(0));
            }
            report.layers.push(LayerReport {
                saturated: saturated(&all),
                relative_error: relative_error(&all, &exact),
            });
        }
        Ok(report)
    }

    fn prefix(&self, count: usize, output: Output) -> Result<IntegerMlp<'_>, IntegerError> {
        let layers = self.layers[..count]
            .iter()
            .map(IntegerLayer::view)
            .collect::<Result<Vec<_>, _>>()?;
        Ok(IntegerMlp::new(&layers, output)?)
    }
}

/// The most fraction bits with which a number of this size fits 16 bits.
fn fraction_bits(largest: f64) -> u8 {
    (0..=MAX_FRACTION_BITS)
        .rev()
        .find(|&bits| largest * one(bits) <= f64::from(MAX_ACTIVATION))
        .unwrap_or(0)
}

fn one(fraction_bits: u8) -> f64 {
    f64::from(1_u32 << fraction_bits)
}

fn largest(values: &[f32]) -> f64 {
    values
        .iter()
        .fold(0.0, |largest, v| largest.max(f64::from(v.abs())))
}

fn saturated(values: &[i16]) -> usize {
    values
        .iter()
        .filter(|v| v.unsigned_abs() == MAX_ACTIVATION.unsigned_abs())
        .count()
}

fn means(values: &[f32], width: usize) -> Vec<f64> {
    let mut sums = vec![0.0; width];
    for row in values.chunks_exact(width) {
        for (sum, &v) in sums.iter_mut().zip(row) {
            *sum += f64::from(v);
        }
    }
    let rows = (values.len() / width).max(1) as f64;
    sums.iter().map(|sum| sum / rows).collect()
}

/// The unit of the integers does not matter: it is the one that brings them nearest to the floats.
fn relative_error(integers: &[i16], exact: &[f32]) -> f64 {
    let pairs = || {
        integers
            .iter()
            .zip(exact)
            .map(|(&q, &v)| (f64::from(q), f64::from(v)))
    };
    let (squares, products) = pairs().fold((0.0, 0.0), |(squares, products), (q, v)| {
        (squares + q * q, products + q * v)
    });
    let unit = if squares > 0.0 {
        products / squares
    } else {
        0.0
    };
    let (error, size) = pairs().fold((0.0, 0.0), |(error, size), (q, v)| {
        (error + (q * unit - v).powi(2), size + v * v)
    });
    if size > 0.0 {
        (error / size).sqrt()
    } else {
        0.0
    }
}
