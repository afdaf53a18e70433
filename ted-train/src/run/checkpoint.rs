//! Learner state as a file: named tensors and the number of updates they have seen.

use burn::tensor::{Device, Tensor, TensorData};
use serde::{Deserialize, Serialize};

/// A tensor with its name and shape.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NamedTensor {
    /// Where it belongs, for example `critic/1/weight`.
    pub name: String,
    /// Its dimensions.
    pub shape: Vec<usize>,
    /// Its values in row-major order.
    pub values: Vec<f32>,
}

/// The state of a learner after some number of updates.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// Digest of the configuration that it belongs to.
    pub config_digest: [u8; 32],
    /// Updates made.
    pub step: u64,
    /// Everything that was learned, in a fixed order.
    pub tensors: Vec<NamedTensor>,
}

/// A checkpoint that holds other tensors than this learner has.
#[derive(Debug, thiserror::Error)]
#[error("the checkpoint has no {name} of shape {shape:?}: it belongs to another configuration")]
pub struct ForeignCheckpoint {
    /// The tensor looked for.
    pub name: String,
    /// Its shape.
    pub shape: Vec<usize>,
}

impl Checkpoint {
    /// Adds a tensor.
    pub(crate) fn push<const D: usize>(&mut self, name: String, tensor: &Tensor<D>) {
        let values = tensor
            .clone()
            .into_data()
            .try_to_vec()
            .expect("a float tensor holds f32");
        self.tensors.push(NamedTensor {
            name,
            shape: tensor.dims().to_vec(),
            values,
        });
    }

    /// Fetches the tensor of this name with the shape of `like`.
    pub(crate) fn fetch<const D: usize>(
        &self,
        name: &str,
        like: &Tensor<D>,
        device: &Device,
    ) -> Result<Tensor<D>, ForeignCheckpoint> {
        let shape = like.dims();
        let found = self
            .tensors
            .iter()
            .find(|t| t.name == name && t.shape == shape);
        let size = shape.iter().product::<usize>();
        match found.filter(|t| t.values.len() == size) {
            Some(tensor) => Ok(Tensor::from_data(
                TensorData::new(tensor.values.clone(), shape),
                device,
            )),
            None => Err(ForeignCheckpoint {
                name: name.to_owned(),
                shape: shape.to_vec(),
            }),
        }
    }
}
