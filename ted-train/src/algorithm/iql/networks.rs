//! The four networks of a fleet of lanes, their optimisers, and their initial state.

use burn::tensor::Tensor;

use crate::nn::{Activation, AdamState, Backend, Initialiser, Mlp, MlpShape, Moments};
use crate::rng::Seed;

use super::IqlConfig;

/// Critic heads of a lane; their minimum is the pessimistic value.
pub(super) const HEADS: usize = 2;

/// The actor's mean is squashed into the action range.
pub const ACTOR_OUTPUT: Activation = Activation::Tanh;

/// Everything that implicit Q-learning learns, for several lanes at once.
///
/// Members of the critics are ordered lane by lane: head `h` of lane `l` is member `2 l + h`.
#[derive(Clone)]
pub struct Iql {
    pub(crate) config: IqlConfig,
    pub(crate) backend: Backend,
    pub(crate) step: u64,
    pub(crate) value: Mlp,
    pub(crate) actor: Mlp,
    /// `[lane, 1, action]`, a parameter of its own and not a function of the observation.
    pub(crate) log_std: Tensor<3>,
    pub(crate) critic: Mlp,
    pub(crate) target: Mlp,
    pub(crate) value_adam: AdamState,
    pub(crate) actor_adam: AdamState,
    pub(crate) log_std_adam: Moments<3>,
    pub(crate) critic_adam: AdamState,
}

impl Iql {
    /// Fresh networks: one lane for each seed.
    #[must_use]
    pub fn new(
        config: IqlConfig,
        observation: usize,
        action: usize,
        seeds: &[Seed],
        backend: Backend,
    ) -> Self {
        let shape =
            |inputs, outputs, output| MlpShape::new(inputs, &config.hidden, outputs, output);
        let network = |shape: MlpShape, names: &[&str]| {
            let mut rngs: Vec<_> = seeds
                .iter()
                .flat_map(|s| names.iter().map(|n| s.child(n).rng()))
                .collect();
            Mlp::new(&shape, Initialiser::Orthogonal, &mut rngs, backend)
        };
        let value = network(shape(observation, 1, Activation::Linear), &["value"]);
        let actor = network(shape(observation, action, ACTOR_OUTPUT), &["actor"]);
        let critic = network(
            shape(observation + action, 1, Activation::Linear),
            &["critic/0", "critic/1"],
        );
        let log_std = Tensor::zeros([seeds.len(), 1, action], &backend.device());
        Self {
            value_adam: AdamState::new(&value),
            actor_adam: AdamState::new(&actor),
            log_std_adam: Moments::zeros_like(&log_std),
            critic_adam: AdamState::new(&critic),
            target: critic.clone(),
            step: 0,
            config,
            backend,
            value,
            actor,
            log_std,
            critic,
        }
    }

    /// Lanes that learn side by side.
    #[must_use]
    pub fn lanes(&self) -> usize {
        self.log_std.dims()[0]
    }

    /// Updates made so far, the same number in every lane.
    #[must_use]
    pub fn step(&self) -> u64 {
        self.step
    }

    /// Hyper-parameters.
    #[must_use]
    pub fn config(&self) -> &IqlConfig {
        &self.config
    }
}
