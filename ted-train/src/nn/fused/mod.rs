//! The fast engine for processors: a perceptron in one buffer, every layer one pass, all members and blocks of the batch in
//! parallel.
//!
//! It computes what the tensor operations of [`super::plain`] compute, up to the order of sums and fused multiply-adds, and is
//! tested against them. Its own bits do not depend on the number of threads or members, because each result is one chain of
//! operations whose order its indices give, and no two threads share a result. A machine with other vector registers, or
//! without fused multiply-add, has other last bits.

mod backward;
mod forward;
mod input;
mod layout;
mod narrow;
mod passes;
mod product;
mod scratch;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use burn::tensor::{Device, Tensor, TensorData};
use pulp::Arch;
use rayon::prelude::*;

use super::adam::AdamStep;
use super::{Activation, Linear};
use layout::{BLOCK, Layout, Row, TILE, ZERO, into_panels, panels};
use scratch::Scratch;

/// Parameters of a perceptron, or anything of their shape, member after member.
#[derive(Clone, Debug)]
pub(crate) struct Buffer {
    layout: Arc<Layout>,
    rows: Vec<Row>,
}

/// Gradients of all parameters.
pub(crate) struct Gradients {
    #[cfg(test)]
    layout: Arc<Layout>,
    rows: Scratch,
}

/// What the backward pass needs of a forward pass: of each member and block, the input and the output of every layer.
pub(crate) struct Tape {
    batch: usize,
    blocks: Scratch,
    /// `[member, batch, out]`, where the last activation's gradient needs it.
    output: Option<Tensor<3>>,
}

impl Buffer {
    /// From weights `[member, in, out]` and biases `[member, 1, out]`.
    pub(crate) fn from_layers(layers: &[Linear]) -> Self {
        let sizes: Vec<_> = layers
            .iter()
            .map(|layer| {
                let [_, inputs, outputs] = layer.weight.dims();
                (inputs, outputs)
            })
            .collect();
        let layout = Layout::new(&sizes);
        let members = layers.first().map_or(0, |layer| layer.weight.dims()[0]);
        let mut rows = vec![ZERO; members * layout.rows()];
        for (own, layer) in layout.layers.iter().zip(layers) {
            let (weights, biases) = (values(layer.weight.clone()), values(layer.bias.clone()));
            let numbers = weights
                .chunks_exact(own.inputs * own.outputs)
                .zip(biases.chunks_exact(own.outputs));
            for (rows, (weights, biases)) in rows.chunks_exact_mut(layout.rows()).zip(numbers) {
                own.pack(weights, biases, &mut rows[own.rows.clone()]);
            }
        }
        Self {
            layout: Arc::new(layout),
            rows,
        }
    }

    /// The same numbers as weights and biases of each layer.
    pub(crate) fn layers(&self) -> Vec<Linear> {
        layers(&self.layout, &self.rows)
    }

    /// Zeros of the same shape.
    pub(crate) fn zeros_like(&self) -> Self {
        Self {
            layout: Arc::clone(&self.layout),
            rows: vec![ZERO; self.rows.len()],
        }
    }

    fn members(&self) -> usize {
        self.rows.len() / self.layout.rows()
    }

    /// `[member, batch, in] -> [member, batch, out]`; an input with one member is shared by all.
    pub(crate) fn forward(&self, x: Tensor<3>, output: Activation) -> Tensor<3> {
        let pass = Pass::new(self, x, output);
        let mut y = vec![0.0; pass.outputs()];
        let work = y.par_chunks_mut(pass.outputs() / self.members());
        work.enumerate().for_each(|(member, y)| {
            let work = y.par_chunks_mut(BLOCK * self.layout.outputs());
            work.enumerate().for_each(|(index, y)| {
                let rows = y.len() / self.layout.outputs();
                let mut block = Scratch::new(rows.next_multiple_of(TILE) * pass.panels);
                pass.block(member, index, &mut block, y);
            });
        });
        pass.tensor(y)
    }

    /// The same, keeping what [`Self::gradients`] needs.
    pub(crate) fn forward_tape(&self, x: Tensor<3>, output: Activation) -> (Tensor<3>, Tape) {
        let pass = Pass::new(self, x, output);
        let mut y = vec![0.0; pass.outputs()];
        let mut blocks = Scratch::new(self.members() * padded(pass.batch) * pass.panels);
        let work = y
            .par_chunks_mut(pass.outputs() / self.members())
            .zip(blocks.par_chunks_mut(padded(pass.batch) * pass.panels));
        work.enumerate().for_each(|(member, (y, blocks))| {
            let work = y
                .par_chunks_mut(BLOCK * self.layout.outputs())
                .zip(blocks.par_chunks_mut(BLOCK * pass.panels));
            work.enumerate()
                .for_each(|(index, (y, block))| pass.block(member, index, block, y));
        });
        let batch = pass.batch;
        let y = pass.tensor(y);
        let output = match output {
            Activation::Linear => None,
            Activation::Tanh => Some(y.clone()),
        };
        let tape = Tape {
            batch,
            blocks,
            output,
        };
        (y, tape)
    }

    /// Gradients of a scalar loss in the parameters, from its gradient `[member, batch, out]` in the output.
    pub(crate) fn gradients(&self, tape: &Tape, d_output: Tensor<3>) -> Gradients {
        let (layout, arch, padded) = (&*self.layout, Arch::new(), padded(tape.batch));
        let outputs = layout.output_panels(layout.layers.len());
        let kept = padded * (panels(layout.inputs()) + outputs);
        let deltas = self.deltas(tape, d_output);
        let mut rows = Scratch::new(self.rows.len());
        let work = rows
            .par_chunks_mut(layout.rows())
            .zip(tape.blocks.par_chunks(kept))
            .zip(deltas.par_chunks(padded * outputs));
        work.for_each(|((rows, blocks), deltas)| {
            for_each_panel(layout, rows, |layer, panel, out| {
                backward::gradient(arch, layout, (layer, panel), (blocks, deltas), out);
            });
        });
        Gradients {
            #[cfg(test)]
            layout: Arc::clone(&self.layout),
            rows,
        }
    }

    /// The gradients in the output of every layer, of each member and block, before its activation.
    fn deltas(&self, tape: &Tape, d_output: Tensor<3>) -> Scratch {
        let d_output = match &tape.output {
            None => d_output,
            Some(y) => d_output * (y.clone() * y.clone()).neg().add_scalar(1.0),
        };
        let d_output = values(d_output);
        let (members, layout) = (self.members(), &*self.layout);
        let (arch, padded) = (Arch::new(), padded(tape.batch));
        let outputs = layout.output_panels(layout.layers.len());
        let kept = padded * (panels(layout.inputs()) + outputs);

        let turned = self.turned();
        let turned_rows = turned.len() / members;
        let mut deltas = Scratch::new(members * padded * outputs);
        let work = deltas
            .par_chunks_mut(padded * outputs)
            .zip(tape.blocks.par_chunks(kept))
            .zip(d_output.par_chunks(tape.batch * layout.outputs()));
        work.enumerate()
            .for_each(|(member, ((deltas, blocks), d_output))| {
                let parameters = self.member(member);
                let turned = &turned[member * turned_rows..][..turned_rows];
                let work = deltas
                    .par_chunks_mut(BLOCK * outputs)
                    .zip(blocks.par_chunks(BLOCK * kept / padded))
                    .zip(d_output.par_chunks(BLOCK * layout.outputs()));
                work.for_each(|((deltas, block), d_output)| {
                    let rows = deltas.len() / outputs;
                    let last = (outputs - panels(layout.outputs())) * rows;
                    into_panels(d_output, layout.outputs(), &mut deltas[last..]);
                    backward::deltas(arch, layout, parameters, turned, block, deltas);
                });
            });
        deltas
    }

    /// The transposed weights of every layer that a gradient is sent back through by a matrix product.
    fn turned(&self) -> Scratch {
        let behind = &self.layout.layers[1..];
        let rows: usize = behind.iter().map(backward::turned_rows).sum();
        let mut turned = Scratch::new(rows * self.members());
        if rows > 0 {
            let work = turned.par_chunks_mut(rows).enumerate();
            work.for_each(|(member, mut turned)| {
                for layer in behind.iter().filter(|layer| !layer.narrow) {
                    let own;
                    (own, turned) = turned.split_at_mut(backward::turned_rows(layer));
                    let weights = &self.member(member)[layer.rows.clone()];
                    product::transpose(weights, layer.inputs, layer.outputs, own);
                }
            });
        }
        turned
    }

    fn member(&self, member: usize) -> &[Row] {
        let rows = self.layout.rows();
        &self.rows[member * rows..][..rows]
    }

    /// One step of Adam with the moments `first` and `second`.
    pub(crate) fn adam(
        &mut self,
        first: &mut Self,
        second: &mut Self,
        gradients: &Gradients,
        step: AdamStep,
    ) {
        let (first, second) = (&mut first.rows, &mut second.rows);
        passes::adam(step, &mut self.rows, first, second, &gradients.rows);
    }

    /// `velocity <- momentum velocity + gradient`, then `self <- self - rate velocity`.
    pub(crate) fn descend(
        &mut self,
        velocity: &mut Self,
        gradients: &Gradients,
        constants: [f32; 2],
    ) {
        passes::descend(
            &mut self.rows,
            &mut velocity.rows,
            &gradients.rows,
            constants,
        );
    }

    /// Shrinks each weight matrix whose Frobenius norm is above `limit` to that norm.
    pub(crate) fn project(&mut self, limit: f64) {
        let members = self.rows.par_chunks_mut(self.layout.rows());
        members.for_each(|rows| passes::project(&self.layout, rows, limit));
    }

    /// `self <- (1 - rate) self + rate source`.
    pub(crate) fn polyak(&mut self, source: &Self, rate: f32) {
        passes::polyak(&mut self.rows, &source.rows, rate);
    }
}

#[cfg(test)]
impl Gradients {
    /// The same numbers as weights and biases of each layer.
    pub(crate) fn layers(&self) -> Vec<Linear> {
        layers(&self.layout, &self.rows)
    }
}

/// A batch on its way through a network.
struct Pass<'a> {
    network: &'a Buffer,
    x: Vec<f32>,
    x_members: usize,
    batch: usize,
    device: Device,
    output: Activation,
    /// Of a block: those of its input and of every layer's output.
    panels: usize,
}

impl<'a> Pass<'a> {
    fn new(network: &'a Buffer, x: Tensor<3>, output: Activation) -> Self {
        let [x_members, batch, _] = x.dims();
        let layout = &network.layout;
        Self {
            network,
            x_members,
            batch,
            device: x.device(),
            output,
            panels: panels(layout.inputs()) + layout.output_panels(layout.layers.len()),
            x: values(x),
        }
    }

    /// Numbers in the output.
    fn outputs(&self) -> usize {
        self.network.members() * self.batch * self.network.layout.outputs()
    }

    /// Runs one block of one member.
    fn block(&self, member: usize, index: usize, block: &mut [Row], y: &mut [f32]) {
        let layout = &*self.network.layout;
        let first = member % self.x_members * self.batch + index * BLOCK;
        let x = &self.x[first * layout.inputs()..][..y.len() / layout.outputs() * layout.inputs()];
        let (arch, parameters) = (Arch::new(), self.network.member(member));
        forward::forward(arch, layout, self.output, parameters, x, block, y);
    }

    fn tensor(self, y: Vec<f32>) -> Tensor<3> {
        let shape = [
            self.network.members(),
            self.batch,
            self.network.layout.outputs(),
        ];
        Tensor::from_data(TensorData::new(y, shape), &self.device)
    }
}

/// Rows of a batch when its last block is filled up.
fn padded(batch: usize) -> usize {
    batch.next_multiple_of(TILE)
}

/// Hands out the panels of every wide layer, and each narrow layer as a whole.
fn for_each_panel(
    layout: &Layout,
    mut rows: &mut [Row],
    body: impl Fn(usize, usize, &mut [Row]) + Sync,
) {
    let body = &body;
    rayon::scope(move |scope| {
        for (index, layer) in layout.layers.iter().enumerate() {
            let own;
            (own, rows) = rows.split_at_mut(layer.rows.len());
            for (panel, out) in own.chunks_exact_mut(layer.panel_rows()).enumerate() {
                scope.spawn(move |_| body(index, panel, out));
            }
        }
    });
}

/// Weights `[member, in, out]` and biases `[member, 1, out]` of each layer, on burn's CPU device.
fn layers(layout: &Layout, rows: &[Row]) -> Vec<Linear> {
    let members = rows.len() / layout.rows();
    let device = Device::flex();
    let of_layer = |layer: &layout::Layer| {
        let (mut weights, mut biases) = (Vec::new(), Vec::new());
        for rows in rows.chunks_exact(layout.rows()) {
            layer.unpack(&rows[layer.rows.clone()], &mut weights, &mut biases);
        }
        let weight = TensorData::new(weights, [members, layer.inputs, layer.outputs]);
        let bias = TensorData::new(biases, [members, 1, layer.outputs]);
        Linear {
            weight: Tensor::from_data(weight, &device),
            bias: Tensor::from_data(bias, &device),
        }
    };
    layout.layers.iter().map(of_layer).collect()
}

fn values(tensor: Tensor<3>) -> Vec<f32> {
    let values = tensor.into_data().try_to_vec();
    values.expect("a float tensor holds f32")
}
