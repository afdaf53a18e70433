//! A transformer with GPT-2's blocks (Vaswani et al. 2017, Radford et al. 2019), forward and backward, over burn tensors.
//!
//! ```text
//! y      = x + dropout(attention(norm(x)) W_o + b_o)
//! z      = y + dropout(relu(norm(y) W_1 + b_1) W_2 + b_2)          one block
//! output = norm(z)                                                 after the last one
//! ```
//!
//! Tokens are rows: `[1, sequences * tokens, width]`, the sequences one after the other. So every dense layer is one matrix
//! product over all of them, and its weights have the type that a perceptron's have, with one member.
//!
//! Gradients are written out, as everywhere in [`crate::nn`]; they are tested against a plain reference in double precision.
//! What is dropped is drawn from a named stream with the update's number, so that a resumed training drops the same.

mod attention;
mod block;
mod dense;
mod dropout;
mod embedding;
mod norm;
mod sequences;
mod sliding;
mod softmax;
mod stack;
#[cfg(test)]
mod tests;

pub(crate) use dense::{backward, dense, forward, tensors};
pub(crate) use dropout::Dropout;
pub(crate) use embedding::{Embedding, EmbeddingTape};
pub(crate) use sequences::{Readout, Sequences};
pub(crate) use softmax::{softmax, softmax_gradient};
pub(crate) use stack::{Tape, Transformer, TransformerShape};
