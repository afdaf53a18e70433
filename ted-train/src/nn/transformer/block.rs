//! One block: attention and a perceptron, each behind a normalisation and beside a path that leaves the rows as they are.

use burn::tensor::{Device, Tensor};
use rand::Rng;

use super::attention::{Attention, AttentionTape};
use super::dense::{self, backward, dense, forward};
use super::dropout::{Dropout, masked};
use super::norm::{LayerNorm, NormTape};
use super::sequences::{Readout, Sequences};
use super::stack::TransformerShape;
use crate::nn::{Linear, host};

/// Parameters; also the type of their gradients.
#[derive(Clone, Debug)]
pub(super) struct Block {
    pub(super) before_attention: LayerNorm,
    pub(super) attention: Attention,
    pub(super) before_perceptron: LayerNorm,
    /// `[1, width, 4 width]`.
    pub(super) hidden: Linear,
    /// `[1, 4 width, width]`.
    pub(super) output: Linear,
}

/// What the backward pass needs.
pub(super) struct BlockTape {
    readout: Readout,
    before_attention: NormTape,
    attention: AttentionTape,
    attention_mask: Option<Tensor<3>>,
    before_perceptron: NormTape,
    normal: Tensor<3>,
    active: Tensor<3>,
    perceptron_mask: Option<Tensor<3>>,
}

impl Block {
    pub(super) fn new(shape: &TransformerShape, rng: &mut impl Rng, device: &Device) -> Self {
        let width = shape.width;
        Self {
            before_attention: LayerNorm::new(width, device),
            attention: Attention::new(width, shape.heads, shape.causal, rng, device),
            before_perceptron: LayerNorm::new(width, device),
            hidden: dense(width, 4 * width, rng, device),
            output: dense(4 * width, width, rng, device),
        }
    }

    pub(super) fn tensors(&mut self) -> Vec<&mut Tensor<3>> {
        let mut tensors = self.before_attention.tensors();
        tensors.extend(self.attention.tensors());
        tensors.extend(self.before_perceptron.tensors());
        tensors.extend(dense::tensors(&mut self.hidden));
        tensors.extend(dense::tensors(&mut self.output));
        tensors
    }

    /// `[1, rows, width] -> [1, read rows, width]`.
    pub(super) fn forward(
        &self,
        x: Tensor<3>,
        sequences: Sequences,
        dropout: &Dropout,
        place: &str,
    ) -> (Tensor<3>, BlockTape) {
        let (device, readout) = (x.device(), sequences.readout);
        let (normal, before_attention) = self.before_attention.forward(x.clone());
        let (mixed, attention) = self.attention.forward(normal, sequences, dropout, place);
        let mask = |what, dims| dropout.mask(&format!("{place}/{what}"), dims, &device);
        let attention_mask = mask("mixed", mixed.dims());
        let y = readout.pick(x) + masked(mixed, attention_mask.as_ref());

        let (normal, before_perceptron) = self.before_perceptron.forward(y.clone());
        let active = forward(&self.hidden, normal.clone(), true);
        let out = forward(&self.output, active.clone(), false);
        let perceptron_mask = mask("perceptron", out.dims());
        let z = y + masked(out, perceptron_mask.as_ref());
        let tape = BlockTape {
            readout,
            before_attention,
            attention,
            attention_mask,
            before_perceptron,
            normal,
            active,
            perceptron_mask,
        };
        (z, tape)
    }

    /// Gradients of the parameters, and the gradient in the rows.
    pub(super) fn backward(&self, tape: BlockTape, d_z: Tensor<3>) -> (Self, Tensor<3>) {
        let d_out = masked(d_z.clone(), tape.perceptron_mask.as_ref());
        let (output, d_active) = backward(&self.output, tape.active.clone(), d_out);
        let d_active = host::mask_inactive(d_active, tape.active);
        let (hidden, d_normal) = backward(&self.hidden, tape.normal, d_active);
        let (before_perceptron, d_y) = self
            .before_perceptron
            .backward(tape.before_perceptron, d_normal);
        let d_y = d_z + d_y;

        let d_mixed = masked(d_y.clone(), tape.attention_mask.as_ref());
        let (attention, d_read, d_all) = self.attention.backward(tape.attention, d_mixed);
        let d_normal = d_all + tape.readout.spread(d_read);
        let (before_attention, d_x) = self
            .before_attention
            .backward(tape.before_attention, d_normal);
        let gradients = Self {
            before_attention,
            attention,
            before_perceptron,
            hidden,
            output,
        };
        (gradients, d_x + tape.readout.spread(d_y))
    }
}
