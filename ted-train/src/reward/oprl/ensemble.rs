//! The ensemble: one perceptron with a member axis, trained on preferences and asked for rewards.

use burn::tensor::{Tensor, TensorData};

use crate::dataset::{Dataset, ObservationStatistics, Segment};
use crate::nn::{AdamState, Backend, ExportedMlp, Mlp, MlpShape};
use crate::preferences::LabelledPair;
use crate::reward::loss::bradley_terry;
use crate::reward::{ExportedEnsemble, Fit, InputMap};
use crate::rng::Seed;

use super::config::OprlConfig;

/// Reward networks that differ in their initial weights and in their first query.
#[derive(Clone)]
pub struct Ensemble {
    pub(crate) network: Mlp,
    pub(crate) inputs: InputMap,
    config: OprlConfig,
    backend: Backend,
}

impl Ensemble {
    /// Fresh members, each drawn from its own stream.
    #[must_use]
    pub fn new(
        config: &OprlConfig,
        statistics: &ObservationStatistics,
        action_dim: usize,
        seed: Seed,
        backend: Backend,
    ) -> Self {
        let inputs = InputMap::new(config.inputs, config.scaling, statistics, action_dim);
        let shape = MlpShape::new(inputs.width(), &config.hidden, 1, config.output);
        let mut rngs: Vec<_> = (0..config.members)
            .map(|m| seed.child(&format!("member/{m}")).rng())
            .collect();
        let network = Mlp::new(&shape, config.initialiser, &mut rngs, backend);
        Self {
            network,
            inputs,
            config: config.clone(),
            backend,
        }
    }

    /// Full-batch training on the pairs of each member, all members having equally many and all segments the same length; a
    /// new Adam each time. After each epoch `going_on` is asked; when it says no, there is no fit and the ensemble is of no
    /// use.
    pub fn train(
        &mut self,
        dataset: &Dataset,
        pairs: &[Vec<LabelledPair>],
        going_on: &mut dyn FnMut() -> bool,
    ) -> Option<Fit> {
        let device = self.backend.device();
        let (members, count) = (pairs.len(), pairs[0].len());
        let segment = pairs[0][0].segments[0].len() as usize;
        let mut rows = Vec::with_capacity(members * count * 2 * segment * self.inputs.width());
        let mut labels = Vec::with_capacity(members * count);
        for pair in pairs.iter().flatten() {
            labels.push(pair.label);
            for step in pair.segments.iter().flat_map(|s| s.steps(dataset)) {
                self.inputs.push(dataset, step, &mut rows);
            }
        }
        let batch = count * 2 * segment;
        let x: Tensor<3> = Tensor::from_data(
            TensorData::new(rows, [members, batch, self.inputs.width()]),
            &device,
        );
        let y: Tensor<3> = Tensor::from_data(TensorData::new(labels, [members, count, 1]), &device);

        let returns = |rewards: Tensor<3>| -> Tensor<3> {
            rewards
                .reshape([members, count * 2, segment])
                .sum_dim(2)
                .reshape([members, count, 2])
        };
        let mut adam = AdamState::new(&self.network);
        for epoch in 1..=u64::from(self.config.epochs) {
            let (rewards, tape) = self.network.forward_tape(x.clone());
            let (_, d_returns) = bradley_terry(returns(rewards), y.clone());
            // Every step of a segment carries the gradient of the segment's return.
            let d_rewards = d_returns
                .reshape([members, count * 2, 1])
                .expand([members, count * 2, segment])
                .reshape([members, batch, 1]);
            let gradients = self.network.gradients(tape, d_rewards);
            let rate = self.config.learning_rate;
            self.config
                .adam
                .step(&mut self.network, &mut adam, gradients, rate, epoch);
            if !going_on() {
                return None;
            }
        }

        let returns = returns(self.network.forward(x));
        let (loss, _) = bradley_terry(returns.clone(), y);
        let returns: Vec<f32> = returns
            .into_data()
            .try_to_vec()
            .expect("a float tensor holds f32");
        let second_first = pairs
            .iter()
            .flatten()
            .zip(returns.chunks_exact(2))
            .map(|(pair, r)| (pair.label, r[1] > r[0]));
        Some(Fit::new(loss.mean().into_scalar::<f32>(), second_first))
    }

    /// Takes the weights off the device.
    #[must_use]
    pub fn exported(&self) -> ExportedEnsemble {
        ExportedEnsemble {
            inputs: self.inputs.clone(),
            members: ExportedMlp::members(&self.network),
        }
    }

    /// Return of each segment as each member sees it, `[member][segment]`; all segments have the same length.
    #[must_use]
    pub fn segment_returns(&self, dataset: &Dataset, segments: &[Segment]) -> Vec<Vec<f32>> {
        /// Segments in one forward pass: large enough to be efficient, small enough to stay in cache.
        const CHUNK: usize = 64;
        let device = self.backend.device();
        let mut returns = vec![Vec::with_capacity(segments.len()); self.config.members];
        for chunk in segments.chunks(CHUNK) {
            let mut rows = Vec::new();
            for step in chunk.iter().flat_map(|s| s.steps(dataset)) {
                self.inputs.push(dataset, step, &mut rows);
            }
            let length = chunk[0].len() as usize;
            let shape = [1, chunk.len() * length, self.inputs.width()];
            let rewards = self
                .network
                .forward(Tensor::from_data(TensorData::new(rows, shape), &device));
            let sums = rewards
                .reshape([self.config.members, chunk.len(), length])
                .sum_dim(2);
            let sums: Vec<f32> = sums
                .into_data()
                .try_to_vec()
                .expect("a float tensor holds f32");
            for (member, sums) in returns.iter_mut().zip(sums.chunks_exact(chunk.len())) {
                member.extend_from_slice(sums);
            }
        }
        returns
    }
}
