//! Layer normalisation (Ba et al. 2016): every row to mean 0 and deviation 1, then a gain and a bias of each column.

use burn::tensor::{Device, Tensor};
use rayon::prelude::*;

use crate::nn::host::in_place;

/// Added to a row's variance: GPT-2's constant.
pub(super) const EPSILON: f32 = 1e-5;

/// Rows that one job sums the gradients of; their sums are added in order, whatever the number of threads.
const ROWS: usize = 128;

/// Gain and bias, `[1, 1, width]`; also the type of their gradients.
#[derive(Clone, Debug)]
pub(super) struct LayerNorm {
    pub(super) gain: Tensor<3>,
    pub(super) bias: Tensor<3>,
}

/// What the backward pass needs: the normalised rows, and what each was multiplied by.
pub(super) struct NormTape {
    normal: Tensor<3>,
    scale: Vec<f32>,
}

impl LayerNorm {
    /// Gain 1 and bias 0.
    pub(super) fn new(width: usize, device: &Device) -> Self {
        Self {
            gain: Tensor::ones([1, 1, width], device),
            bias: Tensor::zeros([1, 1, width], device),
        }
    }

    /// The parameters in a fixed order.
    pub(super) fn tensors(&mut self) -> Vec<&mut Tensor<3>> {
        vec![&mut self.gain, &mut self.bias]
    }

    /// `[1, rows, width]`, the same shape out.
    pub(super) fn forward(&self, x: Tensor<3>) -> (Tensor<3>, NormTape) {
        let [_, rows, width] = x.dims();
        let (gain, bias) = (self.gain.to_data(), self.bias.to_data());
        let gain = gain.as_slice::<f32>().expect("parameters are f32");
        let bias = bias.as_slice::<f32>().expect("parameters are f32");
        let (mut normal, mut y) = (x.clone(), x);
        let mut scale = vec![0.0; rows];
        in_place([&mut normal, &mut y], |[normal, y]| {
            let rows = normal.par_chunks_mut(width).zip(y.par_chunks_mut(width));
            let work = rows.zip(&mut scale).with_min_len(ROWS / 4);
            work.for_each(|((normal, y), scale)| {
                let mean = sum(normal) / width as f32;
                normal.iter_mut().for_each(|x| *x -= mean);
                *scale = 1.0 / (dot(normal, normal) / width as f32 + EPSILON).sqrt();
                let columns = y.iter_mut().zip(gain.iter().zip(bias));
                for (normal, (y, (gain, bias))) in normal.iter_mut().zip(columns) {
                    *normal *= *scale;
                    *y = *normal * gain + bias;
                }
            });
        });
        (y, NormTape { normal, scale })
    }

    /// Gradients of gain and bias, and the gradient in the rows.
    pub(super) fn backward(&self, tape: NormTape, d_y: Tensor<3>) -> (Self, Tensor<3>) {
        let [_, _, width] = d_y.dims();
        let gain = self.gain.to_data();
        let gain = gain.as_slice::<f32>().expect("parameters are f32");
        let NormTape { mut normal, scale } = tape;
        let (mut d_x, device) = (d_y.clone(), d_y.device());
        let mut sums = Vec::new();
        in_place([&mut d_x, &mut normal], |[d_x, normal]| {
            let jobs = d_x
                .par_chunks_mut(ROWS * width)
                .zip(normal.par_chunks(ROWS * width))
                .zip(scale.par_chunks(ROWS));
            sums = jobs
                .map(|((d_x, normal), scale)| {
                    let mut sums = [vec![0.0; width], vec![0.0; width]];
                    let rows = d_x.chunks_mut(width).zip(normal.chunks(width)).zip(scale);
                    rows.for_each(|((d, normal), &scale)| row(d, normal, scale, gain, &mut sums));
                    sums
                })
                .collect();
        });
        let total = |which: usize| -> Tensor<3> {
            let mut total = vec![0.0f32; width];
            for sums in &sums {
                add(&mut total, &sums[which]);
            }
            Tensor::<1>::from_floats(total.as_slice(), &device).reshape([1, 1, width])
        };
        let gradients = Self {
            gain: total(0),
            bias: total(1),
        };
        (gradients, d_x)
    }
}

/// One row's gradient, in place, and its share of the parameters' gradients.
fn row(d: &mut [f32], normal: &[f32], scale: f32, gain: &[f32], sums: &mut [Vec<f32>; 2]) {
    let width = d.len() as f32;
    add(&mut sums[1], d);
    for ((d, normal), (sum, gain)) in d.iter_mut().zip(normal).zip(sums[0].iter_mut().zip(gain)) {
        *sum += *d * normal;
        *d *= gain;
    }
    let (mean, along) = (sum(d) / width, dot(d, normal) / width);
    for (d, normal) in d.iter_mut().zip(normal) {
        *d = scale * (*d - mean - normal * along);
    }
}

fn add(total: &mut [f32], more: &[f32]) {
    total.iter_mut().zip(more).for_each(|(t, m)| *t += m);
}

/// Sum in eight chains, in an order that the indices give.
fn sum(values: &[f32]) -> f32 {
    let (blocks, rest) = values.as_chunks::<8>();
    let mut sums = [0.0f32; 8];
    for block in blocks {
        for (sum, value) in sums.iter_mut().zip(block) {
            *sum += value;
        }
    }
    sums.iter().chain(rest).sum()
}

/// Sum of products in eight chains, in an order that the indices give.
pub(super) fn dot(a: &[f32], b: &[f32]) -> f32 {
    let ((a, rest_a), (b, rest_b)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    let mut sums = [0.0f32; 8];
    for (a, b) in a.iter().zip(b) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += a * b;
        }
    }
    let rest = rest_a.iter().zip(rest_b).map(|(a, b)| a * b);
    sums.into_iter().chain(rest).sum()
}
