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

/// The state of one lane of a learner after some number of updates. It says nothing about the others: a run can be begun in
/// company and gone on with alone.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// Digest of the configuration that it belongs to.
    pub config_digest: [u8; 32],
    /// Updates made.
    pub step: u64,
    /// Everything that was learned, in a fixed order.
    pub tensors: Vec<NamedTensor>,
}

/// Checkpoints that a learner cannot go on from.
#[derive(Debug, thiserror::Error)]
pub enum ForeignCheckpoint {
    /// One holds other tensors than this learner has.
    #[error("the checkpoint has no {name} of shape {shape:?}: it belongs to another configuration")]
    Tensor {
        /// The tensor looked for.
        name: String,
        /// Its shape.
        shape: Vec<usize>,
    },
    /// Lanes that are at different updates, or another number of lanes.
    #[error(
        "a learner of {lanes} lanes goes on from a checkpoint of each, all after the same update, not after updates {steps:?}"
    )]
    Lanes {
        /// Lanes of the learner.
        lanes: usize,
        /// Updates of the checkpoints.
        steps: Vec<u64>,
    },
}

/// Looks at the tensors of a learner, one after the other, and may replace each.
pub(crate) type Visit<'v> =
    &'v mut dyn FnMut(String, &mut Tensor<3>) -> Result<(), ForeignCheckpoint>;

impl Checkpoint {
    /// What lane `lane` of `lanes` has after `step` updates; `each` shows every tensor, always in the same order.
    pub(crate) fn of_lane(
        config_digest: [u8; 32],
        step: u64,
        [lane, lanes]: [usize; 2],
        each: impl FnOnce(Visit<'_>) -> Result<(), ForeignCheckpoint>,
    ) -> Self {
        let mut checkpoint = Self {
            config_digest,
            step,
            tensors: Vec::new(),
        };
        each(&mut |name, tensor| {
            checkpoint.push(name, tensor, lane, lanes);
            Ok(())
        })
        .unwrap_or_else(|error| unreachable!("pushing cannot fail: {error}"));
        checkpoint
    }

    /// Puts a checkpoint of each lane into the tensors that `each` shows, and says after which update they were saved.
    ///
    /// # Errors
    /// When they were saved after different updates, or one lacks a tensor or has another shape.
    pub(crate) fn restore_lanes(
        saved: &[&Self],
        lanes: usize,
        device: &Device,
        each: impl FnOnce(Visit<'_>) -> Result<(), ForeignCheckpoint>,
    ) -> Result<u64, ForeignCheckpoint> {
        let step = Self::common_step(saved, lanes)?;
        each(&mut |name, tensor| {
            *tensor = Self::fetch(saved, &name, tensor, device)?;
            Ok(())
        })?;
        Ok(step)
    }

    /// Adds what belongs to lane `lane` of `lanes` in a tensor whose first axis goes lane by lane.
    pub(crate) fn push<const D: usize>(
        &mut self,
        name: String,
        tensor: &Tensor<D>,
        lane: usize,
        lanes: usize,
    ) {
        let members = tensor.dims()[0] / lanes;
        let own = tensor.clone().narrow(0, lane * members, members);
        let shape = own.dims().to_vec();
        let values = own.into_data().try_to_vec();
        self.tensors.push(NamedTensor {
            name,
            shape,
            values: values.expect("a float tensor holds f32"),
        });
    }

    /// The tensor of this name from a checkpoint of each lane, lane by lane, with the shape of `like`.
    pub(crate) fn fetch<const D: usize>(
        lanes: &[&Self],
        name: &str,
        like: &Tensor<D>,
        device: &Device,
    ) -> Result<Tensor<D>, ForeignCheckpoint> {
        let shape = like.dims();
        let mut own = shape;
        own[0] /= lanes.len();
        let size = own.iter().product::<usize>();
        let mut values = Vec::with_capacity(size * lanes.len());
        for lane in lanes {
            let mut tensors = lane.tensors.iter();
            let found = tensors.find(|t| t.name == name && t.shape == own);
            match found.filter(|t| t.values.len() == size) {
                Some(tensor) => values.extend_from_slice(&tensor.values),
                None => {
                    return Err(ForeignCheckpoint::Tensor {
                        name: name.to_owned(),
                        shape: own.to_vec(),
                    });
                }
            }
        }
        Ok(Tensor::from_data(TensorData::new(values, shape), device))
    }

    /// The update after which all lanes of a learner go on.
    pub(crate) fn common_step(lanes: &[&Self], learner: usize) -> Result<u64, ForeignCheckpoint> {
        match lanes {
            [first, rest @ ..]
                if lanes.len() == learner && rest.iter().all(|l| l.step == first.step) =>
            {
                Ok(first.step)
            }
            _ => Err(ForeignCheckpoint::Lanes {
                lanes: learner,
                steps: lanes.iter().map(|lane| lane.step).collect(),
            }),
        }
    }
}
