//! One network, layer by layer: what its activations need, what it becomes, and how far that is from what it was.

use serde::{Deserialize, Serialize};
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
#[derive(Clone, Debug, PartialEq)]
pub struct QuantisedNetwork {
    layers: Vec<IntegerLayer>,
    /// What an integer output of 1 stands for, layer by layer.
    units: Vec<f64>,
    output: Output,
    /// Fraction bits of a standardised input.
    pub input_fraction_bits: u8,
    /// Fraction bits of the last layer before its activation.
    pub output_fraction_bits: u8,
}

/// How a network's integers differ from its floats on the calibration inputs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NetworkReport {
    /// How many input values were looked at.
    pub inputs: usize,
    /// Input values that were cut off at the ends of 16 bits.
    pub saturated_inputs: usize,
    /// Its layers, first to last: hidden ones after their ReLU, the last one before its activation.
    pub layers: Vec<LayerReport>,
}

/// How a layer's integers differ from its floats.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LayerReport {
    /// Values that were cut off at the ends of 16 bits. None counts before a tanh, which is flat there.
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
        let (mut layers, mut units) = (Vec::with_capacity(count), Vec::with_capacity(count));
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
            units.push(output_unit);
        }
        Ok(Self {
            layers,
            units,
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
            inputs: calibration.norm.len(),
            saturated_inputs: saturated(&calibration.norm, 1.0 / one(self.input_fraction_bits)),
            layers: Vec::new(),
        };
        for (count, &unit) in (1..).zip(&self.units) {
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
            let last = count == self.layers.len();
            if !last {
                exact.iter_mut().for_each(|v| *v = v.max(0.0));
                all.iter_mut().for_each(|q| *q = (*q).max(0));
            }
            if last && self.output == Output::Tanh {
                // Beyond the end of its table a tanh changes no more: nothing is lost by being cut off there.
                let end = (f64::from(MAX_ACTIVATION) * unit) as f32;
                exact.iter_mut().for_each(|v| *v = v.clamp(-end, end));
            }
            report.layers.push(LayerReport {
                saturated: saturated(&exact, unit),
                relative_error: relative_error(&all, &exact, unit),
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

/// Values that 16 bits of this unit have no room for.
fn saturated(values: &[f32], unit: f64) -> usize {
    // Half a unit more is rounded to the last number there is.
    let end = (f64::from(MAX_ACTIVATION) + 0.5) * unit;
    values.iter().filter(|v| f64::from(v.abs()) > end).count()
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

/// Root mean square of the difference, relative to that of the floats.
fn relative_error(integers: &[i16], exact: &[f32], unit: f64) -> f64 {
    let pairs = integers.iter().zip(exact);
    let (error, size) = pairs.fold((0.0, 0.0), |(error, size), (&q, &v)| {
        let (q, v) = (f64::from(q) * unit, f64::from(v));
        (error + (q - v).powi(2), size + v * v)
    });
    if size > 0.0 {
        (error / size).sqrt()
    } else {
        0.0
    }
}
