//! The parameters as a loaded artefact holds them: one array after the other, each at a multiple of 16 bytes, the first at one
//! of 64. Peers copy weights into places of their own; ted-core borrows them where `ted_policy::ArtifactBytes` put them.

use std::ops::Range;

use crate::network::Network;

const LINE: usize = 64;
const ALIGNMENT: usize = 16 / size_of::<f32>();

/// Shift, scale, then weights and bias of each layer.
pub struct Blob {
    numbers: Vec<f32>,
    arrays: Vec<Range<usize>>,
}

impl Blob {
    pub fn new(network: &Network) -> Self {
        let parameters = network
            .layers
            .iter()
            .flat_map(|layer| [&layer.weights, &layer.bias]);
        let sources: Vec<_> = [&network.shift, &network.scale]
            .into_iter()
            .chain(parameters)
            .collect();
        let length: usize = sources
            .iter()
            .map(|source| source.len().next_multiple_of(ALIGNMENT))
            .sum();
        let mut numbers = vec![0.0; length + LINE];
        let mut position = numbers.as_ptr().align_offset(LINE);
        let mut arrays = Vec::new();
        for source in sources {
            let array = position..position + source.len();
            numbers[array.clone()].copy_from_slice(source);
            position += source.len().next_multiple_of(ALIGNMENT);
            arrays.push(array);
        }
        Self { numbers, arrays }
    }

    /// The arrays in their order.
    pub fn arrays(&self) -> impl Iterator<Item = &[f32]> {
        self.arrays.iter().map(|array| &self.numbers[array.clone()])
    }
}
