//! The slow and plain way, in double precision and one number at a time.

use super::super::{Dropout, Sequences, TransformerShape};
use crate::nn::Backend;
use crate::nn::fixtures::wide;

/// A transformer's parameters, one vector each, in the order of `Transformer::tensors`.
pub(super) struct Reference<'a> {
    pub(super) shape: TransformerShape,
    pub(super) sequences: Sequences,
    pub(super) dropout: &'a Dropout,
}

impl Reference<'_> {
    /// Outputs `[count * read tokens][width]` of the rows `x [count * tokens][width]`.
    pub(super) fn forward(&self, parameters: &[Vec<f64>], x: &[f64]) -> Vec<f64> {
        let width = self.shape.width;
        let mut x = times(x, &self.mask("embedding", [1, x.len() / width, width]));
        let (blocks, last) = parameters.split_at(parameters.len() - 2);
        for (i, block) in blocks.chunks(14).enumerate() {
            let sequences = if i + 1 == self.shape.layers {
                self.sequences
            } else {
                self.sequences.all()
            };
            x = self.block(block, &x, sequences, &format!("block/{i}"));
        }
        norm(&x, &last[0], &last[1])
    }

    fn block(&self, p: &[Vec<f64>], x: &[f64], sequences: Sequences, place: &str) -> Vec<f64> {
        let (w, heads) = (self.shape.width, self.shape.heads);
        let (count, tokens, read) = (sequences.count, sequences.tokens, sequences.read());
        let d = w / heads;
        let normal = norm(x, &p[0], &p[1]);
        let query = dense(&normal, &p[2], &p[3]);
        let key_value = dense(&normal, &p[4], &p[5]);
        let dropped = self.mask(&format!("{place}/attention"), [count, heads, read, tokens]);
        let mut mixed = vec![0.0; count * read * w];
        for s in 0..count {
            for h in 0..heads {
                for r in 0..read {
                    let at = sequences.readout.place(r);
                    let seen = if self.shape.causal { at + 1 } else { tokens };
                    let q = &query[(s * tokens + at) * w + h * d..][..d];
                    let side = |t: usize, part: usize| {
                        &key_value[(s * tokens + t) * 2 * w + part * w + h * d..][..d]
                    };
                    let score = |t: usize| -> f64 {
                        let k = side(t, 0);
                        q.iter().zip(k).map(|(q, k)| q * k).sum::<f64>() / (d as f64).sqrt()
                    };
                    let exps: Vec<f64> = (0..seen).map(|t| score(t).exp()).collect();
                    let total: f64 = exps.iter().sum();
                    for (t, exp) in exps.iter().enumerate() {
                        let kept = dropped[((s * heads + h) * read + r) * tokens + t];
                        for (j, v) in side(t, 1).iter().enumerate() {
                            mixed[(s * read + r) * w + h * d + j] += kept * exp / total * v;
                        }
                    }
                }
            }
        }
        let out = dense(&mixed, &p[6], &p[7]);
        let rows = (0..count * read).map(|row| {
            let (s, r) = (row / read, row % read);
            s * tokens + sequences.readout.place(r)
        });
        let read_rows: Vec<f64> = rows.flat_map(|row| x[row * w..][..w].to_vec()).collect();
        let of_rows = [1, count * read, w];
        let y = plus(
            &read_rows,
            &times(&out, &self.mask(&format!("{place}/mixed"), of_rows)),
        );
        let mut active = dense(&norm(&y, &p[8], &p[9]), &p[10], &p[11]);
        active.iter_mut().for_each(|a| *a = a.max(0.0));
        let out = dense(&active, &p[12], &p[13]);
        plus(
            &y,
            &times(&out, &self.mask(&format!("{place}/perceptron"), of_rows)),
        )
    }

    fn mask<const D: usize>(&self, place: &str, shape: [usize; D]) -> Vec<f64> {
        let mask = self.dropout.mask(place, shape, &Backend::Flex.device());
        mask.map_or(vec![1.0; shape.iter().product()], |mask| {
            wide(&mask.into_data().try_to_vec::<f32>().unwrap())
        })
    }
}

fn norm(x: &[f64], gain: &[f64], bias: &[f64]) -> Vec<f64> {
    let width = gain.len();
    let row = |row: &[f64]| -> Vec<f64> {
        let mean = row.iter().sum::<f64>() / width as f64;
        let variance = row.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / width as f64;
        let scale = 1.0 / (variance + 1e-5).sqrt();
        let columns = row.iter().zip(gain.iter().zip(bias));
        columns
            .map(|(x, (g, b))| (x - mean) * scale * g + b)
            .collect()
    };
    x.chunks(width).flat_map(row).collect()
}

/// Rows times weights `[in][out]`, plus biases.
fn dense(x: &[f64], weight: &[f64], bias: &[f64]) -> Vec<f64> {
    let (outputs, inputs) = (bias.len(), weight.len() / bias.len());
    let row = |x: &[f64]| -> Vec<f64> {
        let dot = |o| {
            (0..inputs)
                .map(|i| x[i] * weight[i * outputs + o])
                .sum::<f64>()
        };
        (0..outputs).map(|o| dot(o) + bias[o]).collect()
    };
    x.chunks(inputs).flat_map(row).collect()
}

fn plus(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

fn times(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a * b).collect()
}
