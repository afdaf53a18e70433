//! The network of a fleet of lanes and its average, the optimiser, and their initial state.

use burn::tensor::Tensor;

use crate::nn::lanes;
use crate::nn::{Activation, AdamState, Backend, Initialiser, Mlp, MlpShape, Moments};
use crate::rng::Seed;

use super::ConditionedConfig;

/// Everything that conditioned behaviour cloning learns, for several lanes at once.
#[derive(Clone)]
pub struct Conditioned {
    pub(super) config: ConditionedConfig,
    pub(super) backend: Backend,
    pub(super) step: u64,
    /// From observations to `f0` and then `h`, `[lane, batch, 2 action]`.
    pub(super) network: Mlp,
    /// The average of its weights, which flies.
    pub(super) average: Mlp,
    pub(super) adam: AdamState,
    /// How much further than the average the best go its way, `[lane, 1, 1]`.
    pub(super) gain: Tensor<3>,
    /// The average of the gain, which flies.
    pub(super) average_gain: Tensor<3>,
    pub(super) gain_adam: Moments<3>,
    /// The share of its aim that each lane flies at, `[lane, 1, 1]`: nothing that is learned, but a finished run has to know it.
    pub(super) advance: Tensor<3>,
}

impl Conditioned {
    /// Fresh networks: one lane for each seed, flown at its aim.
    #[must_use]
    pub fn new(
        config: ConditionedConfig,
        observation: usize,
        action: usize,
        seeds: &[Seed],
        backend: Backend,
    ) -> Self {
        let shape = MlpShape::new(observation, &config.hidden, 2 * action, Activation::Linear);
        let mut rngs: Vec<_> = seeds.iter().map(|s| s.child("network").rng()).collect();
        let mut network = Mlp::new(&shape, Initialiser::UniformFanIn, &mut rngs, backend);
        network.silence(action..2 * action);
        let gain = Tensor::zeros([seeds.len(), 1, 1], &backend.device());
        Self {
            gain_adam: Moments::zeros_like(&gain),
            average_gain: gain.clone(),
            gain,
            adam: AdamState::new(&network),
            average: network.clone(),
            advance: Tensor::ones([seeds.len(), 1, 1], &backend.device()),
            step: 0,
            config,
            backend,
            network,
        }
    }

    /// The same, with the share of its aim that each lane is flown at.
    #[must_use]
    pub fn flown_at(self, advances: &[f32]) -> Self {
        let device = self.backend.device();
        let advance = lanes::tensor(advances, self.lanes(), 1, &device);
        Self { advance, ..self }
    }

    /// Lanes that learn side by side.
    #[must_use]
    pub fn lanes(&self) -> usize {
        self.advance.dims()[0]
    }

    /// Updates made so far, the same number in every lane.
    #[must_use]
    pub fn step(&self) -> u64 {
        self.step
    }

    /// Hyper-parameters.
    #[must_use]
    pub fn config(&self) -> &ConditionedConfig {
        &self.config
    }
}
