//! V and the policy of a fleet of lanes, their momenta, and their initial state.

use crate::nn::{Activation, Backend, Initialiser, Mlp, MlpShape, Velocity};
use crate::rng::Seed;

use super::{AwrConfig, Sweep};

/// Everything that advantage-weighted regression learns, for several lanes at once.
#[derive(Clone)]
pub struct Awr {
    pub(super) config: AwrConfig,
    pub(super) backend: Backend,
    pub(super) lanes: usize,
    pub(super) step: u64,
    /// V over the value scale.
    pub(super) critic: Mlp,
    /// The critic that the iteration began with, whose returns it learns.
    pub(super) begun_with: Mlp,
    pub(super) actor: Mlp,
    pub(super) critic_velocity: Velocity,
    pub(super) actor_velocity: Velocity,
    /// Made again when it is missing.
    pub(super) sweep: Option<Sweep>,
}

impl Awr {
    /// Fresh networks: one lane for each seed.
    #[must_use]
    pub fn new(
        config: AwrConfig,
        observation: usize,
        action: usize,
        seeds: &[Seed],
        backend: Backend,
    ) -> Self {
        let network = |name: &str, outputs, output| {
            let shape = MlpShape::new(observation, &config.hidden, outputs, output);
            let mut rngs: Vec<_> = seeds.iter().map(|s| s.child(name).rng()).collect();
            Mlp::new(&shape, Initialiser::Xavier, &mut rngs, backend)
        };
        let critic = network("critic", 1, Activation::Linear);
        let actor = network("actor", action, Activation::Tanh);
        let actor = with_small_output(actor, config.output_scale);
        Self {
            critic_velocity: Velocity::zero(&critic),
            actor_velocity: Velocity::zero(&actor),
            begun_with: critic.clone(),
            backend,
            lanes: seeds.len(),
            step: 0,
            sweep: None,
            config,
            critic,
            actor,
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
    pub fn config(&self) -> &AwrConfig {
        &self.config
    }
}

/// The same network with a last layer uniform in plus or minus `scale`.
fn with_small_output(mut network: Mlp, scale: f64) -> Mlp {
    let mut layers = network.parameters.layers();
    if let Some(last) = layers.last_mut() {
        let [_, inputs, outputs] = last.weight.dims();
        let factor = scale / Initialiser::xavier_bound(inputs, outputs);
        last.weight = last.weight.clone().mul_scalar(factor);
    }
    network.parameters.set_layers(layers);
    network
}
