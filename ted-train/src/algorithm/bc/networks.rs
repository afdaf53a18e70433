//! The policy of a fleet of lanes, its optimiser, and their initial state.

use crate::nn::{Activation, AdamState, Backend, Initialiser, Mlp, MlpShape};
use crate::rng::Seed;

use super::BcConfig;

/// Everything that behaviour cloning learns, for several lanes at once.
#[derive(Clone)]
pub struct Bc {
    pub(super) config: BcConfig,
    pub(super) backend: Backend,
    pub(super) lanes: usize,
    pub(super) step: u64,
    pub(super) policy: Mlp,
    pub(super) adam: AdamState,
}

impl Bc {
    /// Fresh networks: one lane for each seed.
    #[must_use]
    pub fn new(
        config: BcConfig,
        observation: usize,
        action: usize,
        seeds: &[Seed],
        backend: Backend,
    ) -> Self {
        let shape = MlpShape::new(observation, &config.hidden, action, Activation::Tanh);
        let mut rngs: Vec<_> = seeds.iter().map(|s| s.child("policy").rng()).collect();
        let policy = Mlp::new(&shape, Initialiser::UniformFanIn, &mut rngs, backend);
        Self {
            adam: AdamState::new(&policy),
            backend,
            lanes: seeds.len(),
            step: 0,
            config,
            policy,
        }
    }

    /// Lanes that learn side by side.
    #[must_use]
    pub fn lanes(&self) -> usize {
        self.lanes
    }

    /// Updates made so far, the same number in every lane.
    #[must_use]
    pub fn step(&self) -> u64 {
        self.step
    }

    /// Hyper-parameters.
    #[must_use]
    pub fn config(&self) -> &BcConfig {
        &self.config
    }
}
