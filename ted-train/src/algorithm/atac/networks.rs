//! Policy, critics and entropy coefficient of a fleet of lanes, their optimisers, and their initial state.

use burn::tensor::Tensor;

use crate::nn::lanes;
use crate::nn::{Activation, AdamState, Backend, Initialiser, Mlp, MlpShape, Moments};
use crate::rng::{Seed, standard_normal};

use super::AtacConfig;

/// Critics of a lane; the minimum of their targets is what the Bellman error looks ahead to.
pub(super) const HEADS: usize = 2;

/// Everything that the algorithm learns, for several lanes at once; each network has a member for each lane.
#[derive(Clone)]
pub struct Atac {
    pub(super) config: AtacConfig,
    pub(super) backend: Backend,
    pub(super) step: u64,
    /// Where each lane's noise comes from: a function of the update, so that it needs no saving.
    noise: Vec<Seed>,
    /// From observations to means and then logarithms of standard deviations `[lane, batch, 2 action]`, before tanh.
    pub(super) policy: Mlp,
    pub(super) critics: [Mlp; HEADS],
    pub(super) targets: [Mlp; HEADS],
    /// `[lane, 1, 1]`.
    pub(super) log_alpha: Tensor<3>,
    pub(super) policy_adam: AdamState,
    pub(super) critic_adams: [AdamState; HEADS],
    pub(super) log_alpha_adam: Moments<3>,
}

impl Atac {
    /// Fresh networks: one lane for each seed.
    #[must_use]
    pub fn new(
        config: AtacConfig,
        observation: usize,
        action: usize,
        seeds: &[Seed],
        backend: Backend,
    ) -> Self {
        let network = |name: &str, inputs, outputs| {
            let shape = MlpShape::new(inputs, &config.hidden, outputs, Activation::Linear);
            let mut rngs: Vec<_> = seeds.iter().map(|s| s.child(name).rng()).collect();
            Mlp::new(&shape, Initialiser::UniformFanIn, &mut rngs, backend)
        };
        let policy = with_unit_std(network("policy", observation, 2 * action), action);
        let critics = ["critic/0", "critic/1"].map(|name| network(name, observation + action, 1));
        let log_alpha = Tensor::zeros([seeds.len(), 1, 1], &backend.device());
        Self {
            policy_adam: AdamState::new(&policy),
            critic_adams: critics.each_ref().map(AdamState::new),
            log_alpha_adam: Moments::zeros_like(&log_alpha),
            noise: seeds.iter().map(|s| s.child("noise")).collect(),
            targets: critics.clone(),
            step: 0,
            config,
            backend,
            policy,
            critics,
            log_alpha,
        }
    }

    /// Forgets what only the warm start needs: moments of the optimisers, and alpha.
    pub(super) fn end_warm_start(&mut self) {
        self.policy_adam = AdamState::new(&self.policy);
        self.critic_adams = self.critics.each_ref().map(AdamState::new);
        self.log_alpha = self.log_alpha.zeros_like();
        self.log_alpha_adam = Moments::zeros_like(&self.log_alpha);
    }

    /// Standard normal numbers for the actions at `s` and at `s'` in the next update, `[lane, rows, width]` each.
    pub(super) fn noise(&self, rows: usize, width: usize) -> [Tensor<3>; 2] {
        let mut noise = [Vec::new(), Vec::new()];
        for lane in &self.noise {
            let mut rng = lane.rng_at(self.step);
            for noise in &mut noise {
                noise.extend((0..rows * width).map(|_| standard_normal(&mut rng) as f32));
            }
        }
        let device = self.backend.device();
        noise.map(|noise| lanes::tensor(&noise, self.lanes(), rows, &device))
    }

    /// Lanes that learn side by side.
    #[must_use]
    pub fn lanes(&self) -> usize {
        self.noise.len()
    }

    /// Updates made so far, the same number in every lane.
    #[must_use]
    pub fn step(&self) -> u64 {
        self.step
    }

    /// Hyper-parameters.
    #[must_use]
    pub fn config(&self) -> &AtacConfig {
        &self.config
    }
}

/// The same policy with a standard deviation of one everywhere: no weights, and no bias, behind its logarithm.
fn with_unit_std(mut policy: Mlp, action: usize) -> Mlp {
    let mut layers = policy.parameters.layers();
    if let Some(last) = layers.last_mut() {
        let unit = |t: &Tensor<3>| {
            let mean = t.clone().narrow(2, 0, action);
            Tensor::cat(vec![mean.clone(), mean.zeros_like()], 2)
        };
        last.weight = unit(&last.weight);
        last.bias = unit(&last.bias);
    }
    policy.parameters.set_layers(layers);
    policy
}
