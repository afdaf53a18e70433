//! Where the numbers lie: matrices cut into panels of 32 columns, so that every product reads and writes whole rows of a panel.
//!
//! A matrix `[rows, columns]` is `columns / 32` panels, rounded up, each of `rows` rows of 32 numbers. A wide layer is the
//! panels of its weights `[in, out]` with the biases as one more row, the last of each panel. A narrow layer, a head of a few
//! outputs, is the panels of one output's weights `[1, in]` after those of the other, and a row of biases at the end: a
//! dot product each, where a panel would be mostly empty. What fills up a panel is zero and stays zero.

use std::ops::Range;

/// Columns of a panel.
pub(super) const WIDTH: usize = 32;
/// Rows of a batch that go through a network together.
pub(super) const BLOCK: usize = 64;
/// Rows of a block are filled up to a multiple of this, the height of the largest tile of a product.
pub(super) const TILE: usize = 8;
/// Most outputs of a narrow layer.
const NARROW: usize = 8;

/// One row of a panel, on a cache line of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub(super) struct Row(pub(super) [f32; WIDTH]);

/// Zeros.
pub(super) const ZERO: Row = Row([0.0; WIDTH]);

/// One layer among the rows of a member.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layer {
    pub(super) inputs: usize,
    pub(super) outputs: usize,
    pub(super) narrow: bool,
    /// Its rows.
    pub(super) rows: Range<usize>,
}

/// The layers of a member.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layout {
    pub(super) layers: Vec<Layer>,
}

/// Panels of a matrix with that many columns.
pub(super) fn panels(columns: usize) -> usize {
    columns.div_ceil(WIDTH)
}

impl Layout {
    /// From inputs and outputs of each layer. Only the last one may be narrow: its output is no product's left side.
    pub(super) fn new(sizes: &[(usize, usize)]) -> Self {
        let (mut layers, mut start) = (Vec::with_capacity(sizes.len()), 0);
        for (i, &(inputs, outputs)) in sizes.iter().enumerate() {
            let narrow = i + 1 == sizes.len() && outputs <= NARROW;
            let rows = if narrow {
                outputs * panels(inputs) + 1
            } else {
                panels(outputs) * (inputs + 1)
            };
            layers.push(Layer {
                inputs,
                outputs,
                narrow,
                rows: start..start + rows,
            });
            start += rows;
        }
        Self { layers }
    }

    /// Rows of a member.
    pub(super) fn rows(&self) -> usize {
        self.layers.last().map_or(0, |layer| layer.rows.end)
    }

    /// Width of the input.
    pub(super) fn inputs(&self) -> usize {
        self.layers.first().map_or(0, |layer| layer.inputs)
    }

    /// Width of the output.
    pub(super) fn outputs(&self) -> usize {
        self.layers.last().map_or(0, |layer| layer.outputs)
    }

    /// Panels of the outputs of the first `layers` layers.
    pub(super) fn output_panels(&self, layers: usize) -> usize {
        let of = |layer: &Layer| panels(layer.outputs);
        self.layers[..layers].iter().map(of).sum()
    }
}

impl Layer {
    /// Rows of one of its panels, the last of which is a row of biases; a narrow layer is handled as one panel.
    pub(super) fn panel_rows(&self) -> usize {
        if self.narrow {
            self.rows.len()
        } else {
            self.inputs + 1
        }
    }

    /// Place of a weight: row of the layer and column.
    fn weight(&self, input: usize, output: usize) -> (usize, usize) {
        if self.narrow {
            let row = output * panels(self.inputs) + input / WIDTH;
            (row, input % WIDTH)
        } else {
            let row = output / WIDTH * (self.inputs + 1) + input;
            (row, output % WIDTH)
        }
    }

    /// Place of a bias.
    fn bias(&self, output: usize) -> (usize, usize) {
        if self.narrow {
            (self.outputs * panels(self.inputs), output)
        } else {
            self.weight(self.inputs, output)
        }
    }

    /// Takes weights `[in, out]` in row-major order and biases `[out]` into the layer's rows.
    pub(super) fn pack(&self, weights: &[f32], biases: &[f32], rows: &mut [Row]) {
        let mut put = |(row, column): (usize, usize), value| rows[row].0[column] = value;
        for (at, &weight) in weights.iter().enumerate() {
            put(self.weight(at / self.outputs, at % self.outputs), weight);
        }
        for (output, &bias) in biases.iter().enumerate() {
            put(self.bias(output), bias);
        }
    }

    /// The way back: appends to weights and biases.
    pub(super) fn unpack(&self, rows: &[Row], weights: &mut Vec<f32>, biases: &mut Vec<f32>) {
        let get = |(row, column): (usize, usize)| rows[row].0[column];
        let places = 0..self.inputs * self.outputs;
        weights.extend(places.map(|at| get(self.weight(at / self.outputs, at % self.outputs))));
        biases.extend((0..self.outputs).map(|output| get(self.bias(output))));
    }
}

/// Fills the panels of a block from rows in row-major order; columns and rows that fill up are zero.
pub(super) fn into_panels(values: &[f32], width: usize, block: &mut [Row]) {
    let rows = block.len() / panels(width);
    for (p, panel) in block.chunks_exact_mut(rows).enumerate() {
        let columns = (width - p * WIDTH).min(WIDTH);
        let mut values = values.chunks_exact(width);
        for row in panel {
            *row = ZERO;
            if let Some(values) = values.next() {
                row.0[..columns].copy_from_slice(&values[p * WIDTH..p * WIDTH + columns]);
            }
        }
    }
}

/// The way back: as many rows as `values` holds.
pub(super) fn from_panels(block: &[Row], width: usize, values: &mut [f32]) {
    let rows = block.len() / panels(width);
    for (p, panel) in block.chunks_exact(rows).enumerate() {
        let columns = (width - p * WIDTH).min(WIDTH);
        for (row, values) in panel.iter().zip(values.chunks_exact_mut(width)) {
            values[p * WIDTH..p * WIDTH + columns].copy_from_slice(&row.0[..columns]);
        }
    }
}
