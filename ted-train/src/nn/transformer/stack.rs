//! The blocks one after the other, and the normalisation behind them.

use burn::tensor::{Device, Tensor};
use rand::Rng;

use super::block::{Block, BlockTape};
use super::dropout::{Dropout, masked};
use super::norm::{LayerNorm, NormTape};
use super::sequences::Sequences;

/// Sizes of a transformer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TransformerShape {
    /// Numbers in a token, a multiple of `heads`.
    pub width: usize,
    /// Blocks.
    pub layers: usize,
    /// Heads of each block's attention.
    pub heads: usize,
    /// Whether a token sees only itself and those before it.
    pub causal: bool,
}

/// Parameters; also the type of their gradients.
#[derive(Clone, Debug)]
pub(crate) struct Transformer {
    pub(super) blocks: Vec<Block>,
    pub(super) last: LayerNorm,
}

/// What the backward pass needs.
pub(crate) struct Tape {
    mask: Option<Tensor<3>>,
    blocks: Vec<BlockTape>,
    last: NormTape,
}

impl Transformer {
    /// Fresh blocks: weights from N(0, 1 / inputs), biases 0, gains 1.
    pub(crate) fn new(shape: &TransformerShape, rng: &mut impl Rng, device: &Device) -> Self {
        let blocks = (0..shape.layers).map(|_| Block::new(shape, rng, device));
        Self {
            blocks: blocks.collect(),
            last: LayerNorm::new(shape.width, device),
        }
    }

    /// Every parameter, always in the same order.
    pub(crate) fn tensors(&mut self) -> Vec<&mut Tensor<3>> {
        let mut tensors: Vec<_> = self.blocks.iter_mut().flat_map(Block::tensors).collect();
        tensors.extend(self.last.tensors());
        tensors
    }

    /// `[1, count * tokens, width]` to the outputs `[1, count * read tokens, width]`.
    pub(crate) fn forward(
        &self,
        x: Tensor<3>,
        sequences: Sequences,
        dropout: &Dropout,
    ) -> (Tensor<3>, Tape) {
        let mask = dropout.mask("embedding", x.dims(), &x.device());
        let mut x = masked(x, mask.as_ref());
        let mut blocks = Vec::with_capacity(self.blocks.len());
        for (i, block) in self.blocks.iter().enumerate() {
            let last = i + 1 == self.blocks.len();
            let seen = if last { sequences } else { sequences.all() };
            let (z, tape) = block.forward(x, seen, dropout, &format!("block/{i}"));
            x = z;
            blocks.push(tape);
        }
        let (y, last) = self.last.forward(x);
        (y, Tape { mask, blocks, last })
    }

    /// Gradients of the parameters, and the gradient in the input, from the gradient in the output.
    pub(crate) fn backward(&self, tape: Tape, d_y: Tensor<3>) -> (Self, Tensor<3>) {
        let (last, mut d_x) = self.last.backward(tape.last, d_y);
        let mut blocks = Vec::with_capacity(self.blocks.len());
        for (block, tape) in self.blocks.iter().zip(tape.blocks).rev() {
            let (gradients, d) = block.backward(tape, d_x);
            d_x = d;
            blocks.push(gradients);
        }
        blocks.reverse();
        (Self { blocks, last }, masked(d_x, tape.mask.as_ref()))
    }
}
