//! What one block says of the last step of every window that slides over an episode, without computing a key or a value twice.
//!
//! A window numbers its steps from 1, so a step has other keys and values in each of the windows that it lies in. But what
//! depends on the step and what depends on its number meet in sums only, up to two factors that the normalisations apply:
//!
//! ```text
//! h         = s (g_0 (e + p)) + b_0                        e: the step's token, p: the number's vector, both centred
//! h - mean  = s (u_e + u_p) + c                            centred again: u_e, u_p, c of g_0 e, g_0 p, b_0
//! k and v   = r s (u_e A + u_p A) + r c A + b_1 W + b      A = g_1 W
//! s, r      = 1 / sqrt(variance + epsilon), from |e|^2, |p|^2, e p, |u_e|^2, |u_p|^2, u_e u_p, u_e c, u_p c, |c|^2
//! ```
//!
//! So a score is `r s (q u_e A + q u_p A) + r q c A` but for a constant, and a mixture of values is a sum of the same kind. It is
//! the same function as the forward pass, and the same numbers but for rounding.

use burn::tensor::{Tensor, TensorData};
use rayon::prelude::*;

use super::dense::forward;
use super::embedding::Embedding;
use super::norm::{EPSILON, dot};
use super::stack::Transformer;

/// Rows `[rows][width]` on the host.
struct Rows {
    values: Vec<f32>,
    width: usize,
}

impl Rows {
    fn new(tensor: Tensor<3>) -> Self {
        let width = tensor.dims()[2];
        let values = tensor.into_data().try_to_vec();
        Self {
            values: values.expect("a float tensor holds f32"),
            width,
        }
    }

    fn row(&self, row: usize) -> &[f32] {
        &self.values[row * self.width..][..self.width]
    }

    fn squares(&self) -> Vec<f32> {
        self.values.chunks(self.width).map(|r| dot(r, r)).collect()
    }

    fn along(&self, direction: &[f32]) -> Vec<f32> {
        let rows = self.values.chunks(self.width);
        rows.map(|r| dot(r, direction)).collect()
    }
}

/// Vectors that keys and values are sums of, once for each step's token or once for each number.
struct Parts {
    /// `|e|^2`.
    squares: Vec<f32>,
    /// `|u|^2`.
    scaled_squares: Vec<f32>,
    /// `u c`.
    along: Vec<f32>,
    /// `u A`, keys and then values.
    key_value: Rows,
    /// `e`, `[1, rows, width]`.
    centred: Tensor<3>,
    /// `u`.
    scaled: Tensor<3>,
}

impl Transformer {
    /// The output `[1, windows, width]` at the last token of every window of as many steps as the embedding has numbers, from
    /// the inputs `[1, steps, inputs]` of an episode. None when there is more than one block, or no whole window.
    pub(crate) fn slide(&self, embedding: &Embedding, inputs: Vec<Tensor<3>>) -> Option<Tensor<3>> {
        let [block] = &self.blocks[..] else {
            return None;
        };
        let (kinds, steps) = (inputs.len(), inputs[0].dims()[1]);
        let [_, length, width] = embedding.timestep.dims();
        let windows = (steps + 1)
            .checked_sub(length)
            .filter(|&windows| windows > 0)?;
        let attention = &block.attention;

        let bias = centred(embedding.norm.bias.clone());
        let gain = block.before_attention.gain.clone();
        let projection = attention.key_value.weight.clone();
        let scaled_projection = gain.swap_dims(1, 2) * projection.clone();
        let constant = Rows::new(bias.clone().matmul(scaled_projection.clone()));
        let offset = block.before_attention.bias.clone().matmul(projection);
        let offset = Rows::new(offset + attention.key_value.bias.clone());
        let bias_square = Rows::new(bias.clone()).squares()[0];
        let bias = Rows::new(bias);
        let parts = |rows: Tensor<3>| {
            let centred_rows = centred(rows);
            let scaled = centred(centred_rows.clone() * embedding.norm.gain.clone());
            let on_host = Rows::new(scaled.clone());
            Parts {
                squares: Rows::new(centred_rows.clone()).squares(),
                scaled_squares: on_host.squares(),
                along: on_host.along(bias.row(0)),
                key_value: Rows::new(scaled.clone().matmul(scaled_projection.clone())),
                centred: centred_rows,
                scaled,
            }
        };
        let sums = embedding.kinds.iter().zip(inputs);
        let sums: Vec<_> = sums.map(|(kind, x)| forward(kind, x, false)).collect();
        let last = sums[kinds - 1].clone().narrow(1, length - 1, windows);
        // Row `kind * steps + step`.
        let tokens = parts(Tensor::cat(sums, 1));
        let numbers = parts(embedding.timestep.clone());
        let cross = |tokens: &Tensor<3>, numbers: &Tensor<3>| {
            Rows::new(tokens.clone().matmul(numbers.clone().swap_dims(1, 2)))
        };
        let crossed = cross(&tokens.centred, &numbers.centred);
        let scaled_crossed = cross(&tokens.scaled, &numbers.scaled);

        let number = embedding.timestep.clone().narrow(1, length - 1, 1);
        let (x, _) = embedding.norm.forward(last + number);
        let (normal, _) = block.before_attention.forward(x.clone());
        let query = forward(&attention.query, normal, false).mul_scalar(attention.scale());
        let query = Rows::new(query);

        let n = width as f32;
        // The factors r s and r of a token in the window where it has this number.
        let factors = |token: usize, number: usize| {
            let square = tokens.squares[token] + numbers.squares[number];
            let variance = (square + 2.0 * crossed.row(token)[number]) / n;
            let s = 1.0 / (variance + EPSILON).sqrt();
            let scaled = tokens.scaled_squares[token] + numbers.scaled_squares[number];
            let scaled = scaled + 2.0 * scaled_crossed.row(token)[number];
            let along = tokens.along[token] + numbers.along[number];
            let variance = (s * s * scaled + 2.0 * s * along + bias_square) / n;
            let r = 1.0 / (variance + EPSILON).sqrt();
            (r * s, r)
        };
        let d = width / attention.heads;
        let mut mixed = vec![0.0; windows * width];
        let jobs = mixed.par_chunks_mut(width).enumerate().with_min_len(8);
        jobs.for_each(|(window, mixed)| {
            let tokens_of = |number: usize| (0..kinds).map(move |k| k * steps + window + number);
            let places =
                || (0..length).flat_map(|number| tokens_of(number).map(move |t| (t, number)));
            let factors: Vec<(f32, f32)> = places().map(|(t, number)| factors(t, number)).collect();
            for (head, mixed) in mixed.chunks_exact_mut(d).enumerate() {
                let keys = head * d..(head + 1) * d;
                let values = width + keys.start..width + keys.end;
                let query = &query.row(window)[keys.clone()];
                let along_constant = dot(query, &constant.row(0)[keys.clone()]);
                let along_numbers: Vec<f32> = (0..length)
                    .map(|number| dot(query, &numbers.key_value.row(number)[keys.clone()]))
                    .collect();
                let score = |((token, number), (both, alone)): ((usize, usize), &(f32, f32))| {
                    let along = dot(query, &tokens.key_value.row(token)[keys.clone()]);
                    both * (along + along_numbers[number]) + alone * along_constant
                };
                let mut weights: Vec<f32> = places().zip(&factors).map(score).collect();
                let largest = weights.iter().copied().fold(f32::NEG_INFINITY, f32::max);
                weights.iter_mut().for_each(|w| *w = (*w - largest).exp());
                let total: f32 = weights.iter().sum();

                let mut of_numbers = vec![0.0; length];
                let mut of_constant = 0.0;
                for (((token, number), (both, alone)), weight) in
                    places().zip(&factors).zip(weights)
                {
                    let weight = weight / total;
                    of_numbers[number] += weight * both;
                    of_constant += weight * alone;
                    add(
                        mixed,
                        weight * both,
                        &tokens.key_value.row(token)[values.clone()],
                    );
                }
                for (number, weight) in of_numbers.into_iter().enumerate() {
                    add(
                        mixed,
                        weight,
                        &numbers.key_value.row(number)[values.clone()],
                    );
                }
                add(mixed, of_constant, &constant.row(0)[values.clone()]);
                add(mixed, 1.0, &offset.row(0)[values]);
            }
        });
        let mixed = Tensor::from_data(TensorData::new(mixed, [1, windows, width]), &x.device());
        let y = x + forward(&attention.output, mixed, false);
        let (normal, _) = block.before_perceptron.forward(y.clone());
        let active = forward(&block.hidden, normal, true);
        Some(
            self.last
                .forward(y + forward(&block.output, active, false))
                .0,
        )
    }
}

/// Rows minus their means.
fn centred(rows: Tensor<3>) -> Tensor<3> {
    let mean = rows.clone().mean_dim(2);
    rows - mean
}

fn add(sum: &mut [f32], weight: f32, row: &[f32]) {
    sum.iter_mut().zip(row).for_each(|(s, x)| *s += weight * x);
}
