//! The slow and plain way, in double precision and one number at a time: what the tensor code is tested against.

use super::fixtures::{values, wide};
use super::{Activation, Adam, Linear, Mlp};

/// One member of a perceptron. `parameters` holds, layer after layer, the weights `[in][out]` and then the biases.
#[derive(Clone)]
pub(crate) struct ScalarMlp {
    widths: Vec<usize>,
    output: Activation,
    pub(crate) parameters: Vec<f64>,
}

impl ScalarMlp {
    /// Member `member` of a perceptron.
    pub(crate) fn member(network: &Mlp, member: usize) -> Self {
        let layers = network.parameters.layers();
        let mut widths = vec![layers[0].weight.dims()[1]];
        widths.extend(layers.iter().map(|l| l.weight.dims()[2]));
        Self {
            widths,
            output: network.output(),
            parameters: wide(&flat(&layers, member)),
        }
    }

    /// The same perceptron with other parameters.
    pub(crate) fn with(&self, parameters: &[f64]) -> Self {
        Self {
            parameters: parameters.to_vec(),
            ..self.clone()
        }
    }

    /// The output for one input.
    pub(crate) fn forward(&self, x: &[f64]) -> Vec<f64> {
        let mut h = x.to_vec();
        let mut rest = &self.parameters[..];
        for (i, w) in self.widths.windows(2).enumerate() {
            let (inputs, outputs) = (w[0], w[1]);
            let (weights, after) = rest.split_at(inputs * outputs);
            let (biases, after) = after.split_at(outputs);
            rest = after;
            let last = i + 2 == self.widths.len();
            h = (0..outputs)
                .map(|o| {
                    let dot: f64 = (0..inputs).map(|j| h[j] * weights[j * outputs + o]).sum();
                    let z = dot + biases[o];
                    match (last, self.output) {
                        (false, _) => z.max(0.0),
                        (true, Activation::Linear) => z,
                        (true, Activation::Tanh) => z.tanh(),
                    }
                })
                .collect();
        }
        h
    }
}

/// Adam on one flat vector of parameters.
pub(crate) struct ScalarAdam {
    constants: Adam,
    first: Vec<f64>,
    second: Vec<f64>,
    step: i32,
}

impl ScalarAdam {
    /// Before the first step, on so many parameters.
    pub(crate) fn new(constants: Adam, count: usize) -> Self {
        Self {
            constants,
            first: vec![0.0; count],
            second: vec![0.0; count],
            step: 0,
        }
    }

    /// One step against the gradient.
    pub(crate) fn step(&mut self, parameters: &mut [f64], gradient: &[f64], rate: f64) {
        let Adam {
            beta1,
            beta2,
            epsilon,
        } = self.constants;
        self.step += 1;
        for (i, g) in gradient.iter().enumerate() {
            self.first[i] = beta1 * self.first[i] + (1.0 - beta1) * g;
            self.second[i] = beta2 * self.second[i] + (1.0 - beta2) * g * g;
            let first = self.first[i] / (1.0 - beta1.powi(self.step));
            let second = self.second[i] / (1.0 - beta2.powi(self.step));
            parameters[i] -= rate * first / (second.sqrt() + epsilon);
        }
    }
}

/// Parameters or gradients of one member in the order of [`ScalarMlp::parameters`].
pub(crate) fn flat(layers: &[Linear], member: usize) -> Vec<f32> {
    let own = |tensor: &burn::tensor::Tensor<3>| {
        let all = values(tensor.clone());
        let count = all.len() / tensor.dims()[0];
        all[member * count..(member + 1) * count].to_vec()
    };
    let of_layer = |l: &Linear| [own(&l.weight), own(&l.bias)].concat();
    layers.iter().flat_map(of_layer).collect()
}

/// Gradient of a function by central differences; its error is of order 1e-9 for functions and inputs of order 1.
pub(crate) fn central_differences(at: &[f64], f: impl Fn(&[f64]) -> f64) -> Vec<f64> {
    const H: f64 = 1e-5;
    let mut x = at.to_vec();
    (0..at.len())
        .map(|i| {
            let mut moved = |to: f64| {
                x[i] = to;
                f(&x)
            };
            let slope = (moved(at[i] + H) - moved(at[i] - H)) / (2.0 * H);
            x[i] = at[i];
            slope
        })
        .collect()
}
