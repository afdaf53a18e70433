//! From the steps of clips to tokens: a dense layer for each kind of input, a learned vector for the number of the step, and
//! a normalisation.

use burn::tensor::{Device, Tensor, TensorData};
use rand::Rng;
use rayon::prelude::*;

use super::dense::{dense, forward, gradient, tensors};
use super::norm::{LayerNorm, NormTape};
use crate::nn::Linear;
use crate::nn::host::in_place;

/// Parameters; also the type of their gradients.
#[derive(Clone, Debug)]
pub(crate) struct Embedding {
    /// One for each token of a step, in their order: `[1, inputs, width]`.
    pub(super) kinds: Vec<Linear>,
    /// `[1, numbers, width]`: added to every token of the step with this number.
    pub(super) timestep: Tensor<3>,
    pub(super) norm: LayerNorm,
}

/// What the backward pass needs.
pub(crate) struct EmbeddingTape {
    inputs: Vec<Tensor<3>>,
    starts: Vec<usize>,
    norm: NormTape,
}

impl Embedding {
    /// Layers for inputs of these widths, and vectors for `numbers` steps, from N(0, 1 / inputs) and N(0, 1 / width).
    pub(crate) fn new(
        inputs: &[usize],
        numbers: usize,
        width: usize,
        rng: &mut impl Rng,
        device: &Device,
    ) -> Self {
        let kinds = inputs
            .iter()
            .map(|&inputs| dense(inputs, width, rng, device));
        let kinds = kinds.collect();
        let timestep = dense(width, numbers, rng, device).weight;
        Self {
            kinds,
            timestep: timestep.reshape([1, numbers, width]),
            norm: LayerNorm::new(width, device),
        }
    }

    /// Every parameter, always in the same order.
    pub(crate) fn tensors(&mut self) -> Vec<&mut Tensor<3>> {
        let mut all: Vec<_> = self.kinds.iter_mut().flat_map(tensors).collect();
        all.push(&mut self.timestep);
        all.extend(self.norm.tensors());
        all
    }

    /// Inputs `[1, clips * steps, inputs]` of each kind to tokens `[1, clips * steps * kinds, width]`, those of a step one
    /// after the other. The first step of clip `c` has the number `starts[c]`.
    pub(crate) fn forward(
        &self,
        inputs: Vec<Tensor<3>>,
        starts: Vec<usize>,
    ) -> (Tensor<3>, EmbeddingTape) {
        let [_, rows, _] = inputs[0].dims();
        let (width, kinds, steps) = (self.width(), self.kinds.len(), rows / starts.len());
        let sums = self.kinds.iter().zip(&inputs);
        let sums = sums.map(|(kind, x)| forward(kind, x.clone(), false));
        let mut tokens = Tensor::cat(sums.collect(), 2);
        let timestep = self.timestep.to_data();
        let timestep = timestep.as_slice::<f32>().expect("parameters are f32");
        in_place([&mut tokens], |[tokens]| {
            let rows = tokens.par_chunks_mut(kinds * width).enumerate();
            rows.with_min_len(64).for_each(|(row, tokens)| {
                let number = starts[row / steps] + row % steps;
                let timestep = &timestep[number * width..][..width];
                for token in tokens.chunks_exact_mut(width) {
                    token.iter_mut().zip(timestep).for_each(|(x, t)| *x += t);
                }
            });
        });
        let (tokens, norm) = self.norm.forward(tokens.reshape([1, rows * kinds, width]));
        let tape = EmbeddingTape {
            inputs,
            starts,
            norm,
        };
        (tokens, tape)
    }

    /// Gradients of the parameters, and those in the sums of each kind's layer, `[1, clips * steps, width]`.
    pub(crate) fn backward(
        &self,
        tape: EmbeddingTape,
        d_tokens: Tensor<3>,
    ) -> (Self, Vec<Tensor<3>>) {
        let (norm, d_tokens) = self.norm.backward(tape.norm, d_tokens);
        let [_, tokens, width] = d_tokens.dims();
        let kinds = self.kinds.len();
        let rows = tokens / kinds;
        let steps = rows / tape.starts.len();
        let numbers = self.timestep.dims()[1];
        let device = d_tokens.device();
        let d_steps = d_tokens.reshape([1, rows, kinds * width]);

        let mut d_timestep = vec![0.0f32; numbers * width];
        let data = d_steps.to_data();
        let d_rows = data.as_slice::<f32>().expect("gradients are f32");
        for (row, d_row) in d_rows.chunks_exact(kinds * width).enumerate() {
            let number = tape.starts[row / steps] + row % steps;
            for d in d_row.chunks_exact(width) {
                let sums = &mut d_timestep[number * width..][..width];
                sums.iter_mut().zip(d).for_each(|(sum, d)| *sum += d);
            }
        }
        let d_sums = |kind| d_steps.clone().narrow(2, kind * width, width);
        let d_sums: Vec<Tensor<3>> = (0..kinds).map(d_sums).collect();
        let layers = tape.inputs.into_iter().zip(&d_sums);
        let gradients = Self {
            kinds: layers.map(|(x, d)| gradient(x, d.clone())).collect(),
            timestep: Tensor::from_data(TensorData::new(d_timestep, [1, numbers, width]), &device),
            norm,
        };
        (gradients, d_sums)
    }

    /// The gradient in the inputs of a kind, from that in its layer's sums.
    pub(crate) fn input_gradient(&self, kind: usize, d_sums: Tensor<3>) -> Tensor<3> {
        d_sums.matmul(self.kinds[kind].weight.clone().swap_dims(1, 2))
    }

    fn width(&self) -> usize {
        self.timestep.dims()[2]
    }
}
