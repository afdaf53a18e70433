//! The same observations through every engine of the trainer and `ted-core`.

use burn::tensor::{Tensor, TensorData};
use firmware_sim::interrupt;
use firmware_sim::progress::Audience;
use rayon::prelude::*;
use ted_core::{Policy, Scratch};

use crate::dataset::Dataset;
use crate::nn::{Backend, ExportedMlp, Mlp};

use super::{CrosscheckError, Distance};

/// Observations that go through the networks at once.
const CHUNK: usize = 4096;

/// The differences between the ways to compute an action.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ActionDistances {
    pub fused_core: Distance,
    pub flex_core: Distance,
    pub ndarray_core: Distance,
    pub flex_ndarray: Distance,
}

/// Compares the actions for these rows of the dataset's observations.
pub(super) fn compare(
    policy: &Policy<'_>,
    actor: &ExportedMlp,
    dataset: &Dataset,
    rows: &[usize],
    audience: Audience,
) -> Result<ActionDistances, CrosscheckError> {
    let [fused, flex, ndarray] =
        [Backend::Fused, Backend::Flex, Backend::Ndarray].map(|backend| Actor::new(actor, backend));
    let width = dataset.observation_dim();
    let progress = audience.start("compare actions", rows.len() as u64, "observations");
    let mut all = ActionDistances::default();
    for chunk in rows.chunks(CHUNK) {
        if interrupt::requested() {
            return Err(CrosscheckError::Interrupted);
        }
        let raw: Vec<f32> = chunk
            .iter()
            .flat_map(|row| &dataset.observations()[row * width..(row + 1) * width])
            .copied()
            .collect();
        let core = core_actions(policy, &raw)?;
        let standardised = standardise(policy, &raw);
        let fused = fused.act(standardised.clone(), chunk.len());
        let flex = flex.act(standardised.clone(), chunk.len());
        let ndarray = ndarray.act(standardised, chunk.len());
        all.fused_core = all.fused_core.and(Distance::between(&fused, &core));
        all.flex_core = all.flex_core.and(Distance::between(&flex, &core));
        all.ndarray_core = all.ndarray_core.and(Distance::between(&ndarray, &core));
        all.flex_ndarray = all.flex_ndarray.and(Distance::between(&flex, &ndarray));
        progress.advance(chunk.len() as u64);
    }
    progress.finish();
    Ok(all)
}

/// What the controller would send, observation by observation.
fn core_actions(policy: &Policy<'_>, raw: &[f32]) -> Result<Vec<f32>, CrosscheckError> {
    let mut actions = vec![0.0; raw.len() / policy.observation_dim() * policy.action_dim()];
    raw.par_chunks(policy.observation_dim())
        .zip(actions.par_chunks_mut(policy.action_dim()))
        .try_for_each_init(Scratch::new, |scratch, (observation, action)| {
            policy.act(observation, scratch, action)
        })?;
    Ok(actions)
}

/// The trainer's arithmetic on a batch, written a second time.
fn standardise(policy: &Policy<'_>, raw: &[f32]) -> Vec<f32> {
    let (shift, scale) = (policy.normaliser().shift(), policy.normaliser().scale());
    raw.chunks_exact(shift.len())
        .flat_map(|row| row.iter().zip(shift).zip(scale))
        .map(|((x, shift), scale)| (x - shift) * scale)
        .collect()
}

/// The actor of a checkpoint on one of the engines.
struct Actor {
    network: Mlp,
    backend: Backend,
}

impl Actor {
    fn new(actor: &ExportedMlp, backend: Backend) -> Self {
        let network = Mlp::from_exported(actor, backend);
        Self { network, backend }
    }

    fn act(&self, observations: Vec<f32>, rows: usize) -> Vec<f32> {
        let width = observations.len() / rows;
        let batch = TensorData::new(observations, [1, rows, width]);
        let batch: Tensor<3> = Tensor::from_data(batch, &self.backend.device());
        let actions = self.network.forward(batch).into_data();
        actions.try_to_vec().expect("a float tensor holds f32")
    }
}
