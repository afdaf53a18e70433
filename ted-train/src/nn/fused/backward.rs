//! The way back: first the gradients in every layer's output, block by block, then those of the parameters, panel by panel.

use pulp::Arch;

use super::layout::{BLOCK, Layer, Layout, Row, panels};
use super::narrow::{HeadsBack, HeadsGradient};
use super::product::{Finish, Gradient, Product};

/// Blocks whose panels stay in the cache while a panel of a gradient is summed over them.
const TOGETHER: usize = 4;

/// From the gradient in the last layer's output, the last panels of `deltas`, to those in the outputs of all layers before
/// it. `block` is what the forward pass kept; `turned` holds the transposed weights of each layer but the first.
pub(super) fn deltas(
    arch: Arch,
    layout: &Layout,
    parameters: &[Row],
    turned: &[Row],
    block: &[Row],
    deltas: &mut [Row],
) {
    let count = layout.layers.len();
    let rows = deltas.len() / layout.output_panels(count);
    let mut turned_end = turned.len();
    for (i, layer) in layout.layers.iter().enumerate().skip(1).rev() {
        let (before, after) = deltas.split_at_mut(layout.output_panels(i) * rows);
        let delta = &after[..panels(layer.outputs) * rows];
        let start = layout.output_panels(i - 1) * rows;
        let out = &mut before[start..];
        // The input of this layer lies behind the network's own.
        let active = &block[panels(layout.inputs()) * rows + start..][..out.len()];
        if layer.narrow {
            arch.dispatch(HeadsBack {
                delta,
                layer: &parameters[layer.rows.clone()],
                outputs: layer.outputs,
                active,
                out,
            });
        } else {
            let turned_start = turned_end - turned_rows(layer);
            arch.dispatch(Product {
                left: delta,
                rows,
                right: &turned[turned_start..turned_end],
                inner: layer.outputs,
                bias: false,
                finish: Finish::Mask(active),
                out,
            });
            turned_end = turned_start;
        }
    }
}

/// Rows of a layer's transposed weights.
pub(super) fn turned_rows(layer: &Layer) -> usize {
    if layer.narrow {
        0
    } else {
        panels(layer.inputs) * layer.outputs
    }
}

/// The gradient of one panel of layer `index`, or of the whole layer if it is narrow, from all blocks of a batch.
pub(super) fn gradient(
    arch: Arch,
    layout: &Layout,
    (index, panel): (usize, usize),
    (blocks, deltas): (&[Row], &[Row]),
    out: &mut [Row],
) {
    let layer = &layout.layers[index];
    let outputs = layout.output_panels(layout.layers.len());
    let inputs = panels(layout.inputs());
    let block = blocks.chunks((inputs + outputs) * BLOCK);
    let pairs: Vec<(&[Row], &[Row])> = block
        .zip(deltas.chunks(outputs * BLOCK))
        .map(|(block, delta)| {
            let rows = delta.len() / outputs;
            let start = match index {
                0 => 0,
                _ => inputs + layout.output_panels(index - 1),
            };
            let left = &block[start * rows..][..panels(layer.inputs) * rows];
            let delta = &delta[(layout.output_panels(index) + panel) * rows..][..rows];
            (left, delta)
        })
        .collect();
    if layer.narrow {
        arch.dispatch(HeadsGradient {
            blocks: &pairs,
            outputs: layer.outputs,
            out,
        });
        return;
    }
    for (i, blocks) in pairs.chunks(TOGETHER).enumerate() {
        arch.dispatch(Gradient {
            blocks,
            fresh: i == 0,
            out: &mut *out,
        });
    }
}
