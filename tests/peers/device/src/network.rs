//! One random 39-256-256-4 network in f32 and in integers, made when the image starts.

use alloc::vec::Vec;

use ted_core::Dense;
use ted_core::integer::{IntegerDense, MAX_WEIGHT};

/// Widths of the policy network, input first.
pub const WIDTHS: [usize; 4] = [39, 256, 256, 4];

/// Widths of a member of the reward ensemble: it sees the observation and the action.
pub const REWARD_WIDTHS: [usize; 4] = [WIDTHS[0] + WIDTHS[3], 256, 256, 1];

/// Members of the reward ensemble.
pub const MEMBERS: u32 = 7;

/// Fraction bits of every activation: they reach 16.
pub const FRACTION_BITS: u8 = 11;

/// One layer in f32 and in integers, row-major.
pub struct Layer {
    /// Number of inputs.
    pub inputs: usize,
    /// Weights in f32.
    pub weights: Vec<f32>,
    /// Biases in f32.
    pub bias: Vec<f32>,
    /// Weights in 8 bits.
    pub weights_q: Vec<i8>,
    /// What each accumulator starts from.
    pub bias_q: Vec<i32>,
    /// Of each output, as a fraction of 2^31.
    pub multipliers: Vec<i32>,
    /// Of each output, to the left.
    pub shifts: Vec<i8>,
}

/// The policy's layers, first to last.
pub fn layers() -> Vec<Layer> {
    network(WIDTHS, 1)
}

/// The layers of each member of the reward ensemble.
pub fn members() -> Vec<Vec<Layer>> {
    (0..MEMBERS)
        .map(|member| network(REWARD_WIDTHS, 100 + member))
        .collect()
}

fn network(widths: [usize; 4], seed: u32) -> Vec<Layer> {
    let mut numbers = Numbers::new(seed);
    widths
        .windows(2)
        .map(|pair| Layer::random(pair[0], pair[1], &mut numbers))
        .collect()
}

/// One observation, standardised.
pub fn observation() -> Vec<f32> {
    let mut numbers = Numbers::new(7);
    (0..WIDTHS[0]).map(|_| 2.0 * numbers.next()).collect()
}

/// The same in 16-bit fixed point.
pub fn fixed(x: &[f32]) -> Vec<i16> {
    x.iter()
        .map(|v| ted_core::quantised::fixed(*v, FRACTION_BITS))
        .collect()
}

/// 1.0 in 16-bit fixed point.
pub fn unit() -> f32 {
    (1_u32 << FRACTION_BITS) as f32
}

impl Layer {
    /// Random weights for a layer of this size, in both kinds of numbers.
    pub fn random(inputs: usize, outputs: usize, numbers: &mut Numbers) -> Self {
        let bound = libm::sqrtf(6.0 / inputs as f32);
        let weights: Vec<f32> = (0..inputs * outputs)
            .map(|_| bound * numbers.next())
            .collect();
        let bias: Vec<f32> = (0..outputs).map(|_| 0.1 * numbers.next()).collect();
        let mut layer = Self {
            inputs,
            weights,
            bias,
            weights_q: Vec::new(),
            bias_q: Vec::new(),
            multipliers: Vec::new(),
            shifts: Vec::new(),
        };
        layer.quantise();
        layer
    }

    /// One scale per output; what goes in and what comes out has the same fixed point.
    fn quantise(&mut self) {
        for (row, bias) in self.weights.chunks(self.inputs).zip(&self.bias) {
            let scale = largest(row) / f32::from(MAX_WEIGHT);
            self.weights_q
                .extend(row.iter().map(|w| libm::roundf(w / scale) as i8));
            self.bias_q.push(libm::roundf(bias / scale * unit()) as i32);
            let (fraction, exponent) = libm::frexp(f64::from(scale));
            self.multipliers.push((fraction * 2_147_483_648.0) as i32);
            self.shifts.push(exponent as i8);
        }
    }

    /// As the f32 network reads it.
    pub fn dense(&self) -> Dense<'_> {
        Dense::new(self.inputs, self.bias.len(), &self.weights, &self.bias).expect("the sizes fit")
    }

    /// As the integer network reads it.
    pub fn integer(&self) -> IntegerDense<'_> {
        IntegerDense::new(
            self.inputs,
            &self.weights_q,
            &self.bias_q,
            &self.multipliers,
            &self.shifts,
        )
        .expect("the ranges hold")
    }
}

/// The largest magnitude.
pub fn largest(values: &[f32]) -> f32 {
    values
        .iter()
        .fold(0.0, |largest: f32, v| largest.max(libm::fabsf(*v)))
}

/// Reproducible numbers in [-1, 1).
pub struct Numbers(u32);

impl Numbers {
    /// From a seed that is not zero.
    pub fn new(seed: u32) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9))
    }

    /// The next one.
    pub fn next(&mut self) -> f32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        (self.0 >> 8) as f32 / (1 << 23) as f32 - 1.0
    }
}
