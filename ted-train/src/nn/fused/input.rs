//! The gradient of a network in its input: what an actor climbs a critic by.

use burn::tensor::{Tensor, TensorData};
use pulp::Arch;
use rayon::prelude::*;

use super::backward::turned_rows;
use super::layout::{BLOCK, Layer, Row, WIDTH, from_panels, panels};
use super::narrow::HeadsBack;
use super::product::{Finish, Product, transpose};
use super::scratch::Scratch;
use super::{Buffer, Tape, padded};

impl Buffer {
    /// Gradient of a scalar loss in the input `[member, batch, in]`, from its gradient `[member, batch, out]` in the output.
    pub(crate) fn input_gradient(&self, tape: &Tape, d_output: Tensor<3>) -> Tensor<3> {
        let device = d_output.device();
        let (layout, arch, padded) = (&*self.layout, Arch::new(), padded(tape.batch));
        let (inputs, outputs) = (layout.inputs(), layout.output_panels(layout.layers.len()));
        let deltas = self.deltas(tape, d_output);
        let mut d_input = vec![0.0; self.members() * tape.batch * inputs];
        let work = d_input
            .par_chunks_mut(tape.batch * inputs)
            .zip(deltas.par_chunks(padded * outputs));
        work.enumerate().for_each(|(member, (d_input, deltas))| {
            let first = &layout.layers[0];
            let weights = &self.member(member)[first.rows.clone()];
            let mut turned = Scratch::new(turned_rows(first));
            if !first.narrow {
                transpose(weights, first.inputs, first.outputs, &mut turned);
            }
            let work = d_input
                .par_chunks_mut(BLOCK * inputs)
                .zip(deltas.par_chunks(BLOCK * outputs));
            work.for_each(|(d_input, deltas)| {
                let rows = deltas.len() / outputs;
                let delta = &deltas[..panels(first.outputs) * rows];
                let mut block = Scratch::new(panels(inputs) * rows);
                through_first_layer(arch, first, (weights, &turned), delta, &mut block);
                from_panels(&block, inputs, d_input);
            });
        });
        let shape = [self.members(), tape.batch, inputs];
        Tensor::from_data(TensorData::new(d_input, shape), &device)
    }
}

/// The gradient in the input of a network, panels of `out`, from that in the output of its first layer. That layer's weights come
/// as they are, for a narrow one, and transposed, for a wide one.
fn through_first_layer(
    arch: Arch,
    layer: &Layer,
    (weights, turned): (&[Row], &[Row]),
    delta: &[Row],
    out: &mut [Row],
) {
    if layer.narrow {
        // No ReLU stands before the input, so nothing is held back.
        let active = vec![Row([1.0; WIDTH]); out.len()];
        arch.dispatch(HeadsBack {
            delta,
            layer: weights,
            outputs: layer.outputs,
            active: &active,
            out,
        });
    } else {
        arch.dispatch(Product {
            left: delta,
            rows: delta.len() / panels(layer.outputs),
            right: turned,
            inner: layer.outputs,
            bias: false,
            finish: Finish::Store,
            out,
        });
    }
}
