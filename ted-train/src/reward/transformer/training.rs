//! The whole update on one screen, and its state as a checkpoint.

use burn::tensor::{Tensor, TensorData};

use crate::checkpoint::{Checkpoint, ForeignCheckpoint};
use crate::dataset::{Dataset, Segment};
use crate::nn::AdamWState;
use crate::nn::transformer::Dropout;
use crate::preferences::LabelledPair;
use crate::reward::Fit;
use crate::reward::loss::bradley_terry;
use crate::rng::Seed;

use super::config::PtConfig;
use super::network::{Clips, RewardTransformer};

/// A transformer in training, with the pairs that it learns from.
pub(super) struct Training<'a> {
    pub(super) transformer: RewardTransformer,
    config: &'a PtConfig,
    adam: AdamWState,
    /// Steps made.
    pub(super) step: u64,
    /// The first clips of all pairs, then the second ones.
    clips: Clips,
    /// `[1, pairs, 1]`.
    labels: Tensor<3>,
    stream: Seed,
}

impl<'a> Training<'a> {
    /// Before the first step; what is dropped comes from the stream `seed/dropout`.
    pub(super) fn new(
        config: &'a PtConfig,
        mut transformer: RewardTransformer,
        dataset: &Dataset,
        pairs: &[LabelledPair],
        seed: Seed,
    ) -> Self {
        let segments: Vec<_> = pairs.iter().map(|pair| pair.segments).collect();
        let clips = pair_clips(&transformer, dataset, &segments);
        let labels = pairs.iter().map(|pair| pair.label).collect();
        let labels = TensorData::new(labels, [1, pairs.len(), 1]);
        let adam = AdamWState::new(transformer.network.tensors());
        Self {
            labels: Tensor::from_data(labels, &transformer.backend.device()),
            clips,
            config,
            adam,
            step: 0,
            stream: seed.child("dropout"),
            transformer,
        }
    }

    /// One step on all pairs; returns the loss before it, with what was dropped.
    pub(super) fn update(&mut self) -> f32 {
        self.transformer.backend.run(|| self.update_here())
    }

    fn update_here(&mut self) -> f32 {
        let network = &mut self.transformer.network;
        let dropout = Dropout::of_update(self.config.dropout, self.stream, self.step, 2);
        let (scores, tape) = network.scores(&self.clips, &dropout);
        let (loss, d_scores) = loss(scores, self.labels.clone());
        let mut gradients = network.gradients(tape, d_scores);

        let rate = self.config.rate.rate(self.step, self.config.steps);
        self.step += 1;
        self.config.adamw.step(
            network.tensors(),
            &mut self.adam,
            gradients.tensors(),
            rate,
            self.step,
        );
        loss.into_scalar::<f32>()
    }

    /// How well the pairs are fitted, nothing being dropped.
    pub(super) fn fit(&self) -> Fit {
        let (scores, _) = self
            .transformer
            .network
            .scores(&self.clips, &Dropout::none());
        let (loss, _) = loss(scores.clone(), self.labels.clone());
        let scores = numbers(&scores);
        let (first, second) = scores.split_at(scores.len() / 2);
        let labels = numbers(&self.labels);
        let second_first = first
            .iter()
            .zip(second)
            .map(|(first, second)| second > first);
        let pairs = labels.iter().copied().zip(second_first);
        Fit::new(loss.into_scalar::<f32>(), pairs)
    }

    /// Everything that the next step depends on, besides the configuration and the answers.
    pub(super) fn checkpoint(&self) -> Checkpoint {
        let mut checkpoint = Checkpoint {
            step: self.step,
            ..Checkpoint::default()
        };
        let mut network = self.transformer.network.clone();
        self.adam
            .save("network", network.tensors(), &mut checkpoint);
        checkpoint
    }

    /// Puts a saved state in the place of this one.
    ///
    /// # Errors
    /// When the checkpoint lacks a tensor or has another shape; this must not be used then.
    pub(super) fn restore(&mut self, checkpoint: &Checkpoint) -> Result<(), ForeignCheckpoint> {
        let parameters = self.transformer.network.tensors();
        self.adam.restore("network", parameters, checkpoint)?;
        self.step = checkpoint.step;
        Ok(())
    }
}

/// The first clips of all pairs, then the second ones.
pub(super) fn pair_clips(
    transformer: &RewardTransformer,
    dataset: &Dataset,
    pairs: &[[Segment; 2]],
) -> Clips {
    let side = |side: usize| pairs.iter().flat_map(move |pair| pair[side].steps(dataset));
    transformer.clips(dataset, side(0).chain(side(1)), 2 * pairs.len())
}

/// The loss of scores `[2 * pairs, 1, 1]`, first clips first, and its gradient in them.
pub(super) fn loss(scores: Tensor<3>, labels: Tensor<3>) -> (Tensor<3>, Tensor<3>) {
    let pairs = labels.dims()[1];
    let returns = scores.reshape([1, 2, pairs]).swap_dims(1, 2);
    let (loss, d_returns) = bradley_terry(returns, labels);
    (loss, d_returns.swap_dims(1, 2).reshape([2 * pairs, 1, 1]))
}

pub(super) fn numbers(tensor: &Tensor<3>) -> Vec<f32> {
    let numbers = tensor.to_data().try_to_vec();
    numbers.expect("a float tensor holds f32")
}
