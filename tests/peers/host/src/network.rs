//! The policy that every engine runs: 39-256-256-4, ReLU between, tanh at the end, made-up numbers.

/// Width of each layer's input, and of the output.
pub const WIDTHS: [usize; 4] = [39, 256, 256, 4];

/// Channels of an observation.
pub const OBSERVATION: usize = WIDTHS[0];

/// Channels of an action.
pub const ACTION: usize = WIDTHS[3];

/// One dense layer: weights row-major `[outputs][inputs]`.
pub struct Layer {
    pub inputs: usize,
    pub outputs: usize,
    pub weights: Vec<f32>,
    pub bias: Vec<f32>,
}

/// The weights of the policy and the standardisation of what it sees.
pub struct Network {
    pub layers: Vec<Layer>,
    pub shift: Vec<f32>,
    pub scale: Vec<f32>,
}

impl Network {
    /// Weights as large as training would begin with, so that half of the hidden units are off and no tanh saturates.
    pub fn new() -> Self {
        let mut numbers = Numbers(0x9e37_79b9_7f4a_7c15);
        let layers = WIDTHS
            .windows(2)
            .map(|pair| {
                let (inputs, outputs) = (pair[0], pair[1]);
                let bound = (3.0 / inputs as f32).sqrt();
                Layer {
                    inputs,
                    outputs,
                    weights: numbers.take(inputs * outputs, bound),
                    bias: numbers.take(outputs, 0.1),
                }
            })
            .collect();
        Self {
            layers,
            shift: numbers.take(OBSERVATION, 0.5),
            scale: numbers
                .take(OBSERVATION, 0.5)
                .iter()
                .map(|v| v + 1.5)
                .collect(),
        }
    }

    /// Raw observations, different ones so that no engine can keep an answer.
    pub fn observations(&self, count: usize) -> Vec<[f32; OBSERVATION]> {
        let mut numbers = Numbers(0x2545_f491_4f6c_dd1d);
        let mut one = || {
            let mut observation = [0.0; OBSERVATION];
            observation.copy_from_slice(&numbers.take(OBSERVATION, 1.0));
            observation
        };
        (0..count).map(|_| one()).collect()
    }

    /// Writes the standardised observation where an engine without an own normaliser reads its input.
    #[inline]
    pub fn standardise(&self, obs_raw: &[f32; OBSERVATION], obs_norm: &mut [f32]) {
        let parameters = self.shift.iter().zip(&self.scale);
        for ((norm, raw), (shift, scale)) in obs_norm.iter_mut().zip(obs_raw).zip(parameters) {
            *norm = (raw - shift) * scale;
        }
    }

    /// The action in 64-bit arithmetic: what all engines are compared with before any is timed.
    pub fn exact(&self, obs_raw: &[f32; OBSERVATION]) -> Vec<f64> {
        let mut values = vec![0.0; OBSERVATION];
        self.standardise(obs_raw, &mut values);
        let mut values: Vec<f64> = values.into_iter().map(f64::from).collect();
        for (index, layer) in self.layers.iter().enumerate() {
            let rows = layer.weights.chunks(layer.inputs).zip(&layer.bias);
            let sums = rows.map(|(row, &bias)| {
                let products = row.iter().zip(&values).map(|(&w, x)| f64::from(w) * x);
                products.sum::<f64>() + f64::from(bias)
            });
            let last = index + 1 == self.layers.len();
            values = sums
                .map(|y| if last { y.tanh() } else { y.max(0.0) })
                .collect();
        }
        values
    }
}

/// A xorshift generator: the same numbers in every run and on every machine.
struct Numbers(u64);

impl Numbers {
    /// `count` numbers in (-bound, bound).
    fn take(&mut self, count: usize, bound: f32) -> Vec<f32> {
        let mut next = || {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            (self.0 >> 40) as f32 / (1 << 23) as f32 - 1.0
        };
        (0..count).map(|_| next() * bound).collect()
    }
}
