//! A block of a batch through one member, all layers after each other while the block is in the cache.

use pulp::Arch;

use crate::nn::Activation;

use super::layout::{Layout, Row, from_panels, into_panels, panels};
use super::narrow::Heads;
use super::product::{Finish, Product};

/// Runs a block: `x` and `y` in row-major order; `block` keeps, as panels, the input and the output of every layer.
pub(super) fn forward(
    arch: Arch,
    layout: &Layout,
    output: Activation,
    parameters: &[Row],
    x: &[f32],
    block: &mut [Row],
    y: &mut [f32],
) {
    let inputs = layout.inputs();
    let rows = block.len() / (panels(inputs) + layout.output_panels(layout.layers.len()));
    let (mut left, mut rest) = block.split_at_mut(panels(inputs) * rows);
    into_panels(x, inputs, left);
    for (i, layer) in layout.layers.iter().enumerate() {
        let (out, after) = rest.split_at_mut(panels(layer.outputs) * rows);
        let parameters = &parameters[layer.rows.clone()];
        if layer.narrow {
            arch.dispatch(Heads {
                left,
                layer: parameters,
                outputs: layer.outputs,
                out,
            });
        } else {
            let last = i + 1 == layout.layers.len();
            arch.dispatch(Product {
                left,
                rows,
                right: parameters,
                inner: layer.inputs,
                bias: true,
                finish: if last { Finish::Store } else { Finish::Relu },
                out,
            });
        }
        (left, rest) = (out, after);
    }
    from_panels(left, layout.outputs(), y);
    if output == Activation::Tanh {
        y.iter_mut().for_each(|y| *y = y.tanh());
    }
}
