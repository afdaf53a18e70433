//! The network: steps to tokens, the transformer, the head.

use burn::tensor::{Tensor, TensorData};

use crate::dataset::{Dataset, ObservationStatistics};
use crate::nn::Backend;
use crate::nn::transformer::{
    Dropout, Embedding, EmbeddingTape, Readout, Sequences, Tape, Transformer, TransformerShape,
};
use crate::rng::Seed;

use super::config::PtConfig;
use super::head::{Head, HeadTape};

/// A trained Preference Transformer, or one in training.
#[derive(Clone, Debug)]
pub struct RewardTransformer {
    pub(super) network: Network,
    pub(super) shift: Vec<f32>,
    pub(super) scale: Vec<f32>,
    pub(super) segment: usize,
    pub(super) backend: Backend,
}

/// Steps of equally long clips, one clip after the other.
#[derive(Clone, Debug)]
pub(super) struct Clips {
    /// `[1, clips * steps, observation]`, scaled.
    pub(super) observations: Tensor<3>,
    /// `[1, clips * steps, action]`.
    pub(super) actions: Tensor<3>,
    pub(super) count: usize,
}

impl Clips {
    pub(super) fn steps(&self) -> usize {
        self.actions.dims()[1] / self.count
    }
}

impl RewardTransformer {
    /// Fresh weights from the stream `seed/network`.
    ///
    /// # Panics
    /// When the width is no multiple of the heads, which the check of a configuration refuses.
    #[must_use]
    pub fn new(
        config: &PtConfig,
        statistics: &ObservationStatistics,
        action_dim: usize,
        seed: Seed,
        backend: Backend,
    ) -> Self {
        assert!(
            config.width.is_multiple_of(config.heads),
            "heads share the width equally"
        );
        let [shift, scale] = config.scaling.shift_and_scale(statistics);
        let inputs = [shift.len(), action_dim];
        Self {
            network: Network::new(config, inputs, seed.child("network"), backend),
            shift,
            scale,
            segment: config.segment as usize,
            backend,
        }
    }

    /// The steps of `count` equally long clips as tensors.
    pub(super) fn clips(
        &self,
        dataset: &Dataset,
        steps: impl Iterator<Item = usize> + Clone,
        count: usize,
    ) -> Clips {
        let device = self.backend.device();
        let (mut observations, mut actions) = (Vec::new(), Vec::new());
        for step in steps {
            let channels = dataset.observation(step).iter();
            let map = self.shift.iter().zip(&self.scale);
            observations.extend(
                channels
                    .zip(map)
                    .map(|(x, (shift, scale))| (x - shift) * scale),
            );
            actions.extend_from_slice(dataset.action(step));
        }
        let rows = actions.len() / dataset.action_dim();
        let tensor = |values: Vec<f32>, width| -> Tensor<3> {
            Tensor::from_data(TensorData::new(values, [1, rows, width]), &device)
        };
        Clips {
            observations: tensor(observations, dataset.observation_dim()),
            actions: tensor(actions, dataset.action_dim()),
            count,
        }
    }
}

/// Parameters; also the type of their gradients.
#[derive(Clone, Debug)]
pub(super) struct Network {
    /// Of actions and of observations; steps are numbered from the clip's start.
    embedding: Embedding,
    transformer: Transformer,
    head: Head,
}

/// What the backward pass needs.
pub(super) struct NetworkTape {
    embedding: EmbeddingTape,
    transformer: Tape,
    head: HeadTape,
}

/// A step's second token is its state; with the action before it, it has seen the whole transition.
const STATE: Readout = Readout {
    group: 2,
    offset: 1,
};

impl Network {
    /// Fresh weights for inputs of these widths: observation and action.
    fn new(config: &PtConfig, inputs: [usize; 2], seed: Seed, backend: Backend) -> Self {
        let (device, width) = (backend.device(), config.width);
        let shape = TransformerShape {
            width,
            layers: config.layers,
            heads: config.heads,
            causal: true,
        };
        let rng = &mut seed.rng();
        let [observation, action] = inputs;
        let steps = config.segment as usize;
        Self {
            embedding: Embedding::new(&[action, observation], steps, width, rng, &device),
            transformer: Transformer::new(&shape, rng, &device),
            head: Head::new(config.head, width, rng, &device),
        }
    }

    /// Every parameter, always in the same order.
    pub(super) fn tensors(&mut self) -> Vec<&mut Tensor<3>> {
        let mut all = self.embedding.tensors();
        all.extend(self.transformer.tensors());
        all.extend(self.head.tensors());
        all
    }

    /// Scores `[clips, 1, 1]` of clips.
    pub(super) fn scores(&self, clips: &Clips, dropout: &Dropout) -> (Tensor<3>, NetworkTape) {
        let (tokens, embedding) = self.tokens(clips);
        let (h, transformer) = self
            .transformer
            .forward(tokens, sequences(clips, STATE), dropout);
        let (scores, head) = self.head.scores(h, clips.count);
        let tape = NetworkTape {
            embedding,
            transformer,
            head,
        };
        (scores, tape)
    }

    /// The reward `[1, clips, 1]` of the last step of each clip.
    pub(super) fn last_rewards(&self, clips: &Clips) -> Tensor<3> {
        let tokens = 2 * clips.steps();
        let last = Readout {
            group: tokens,
            offset: tokens - 1,
        };
        let (tokens, _) = self.tokens(clips);
        let sequences = sequences(clips, last);
        let (h, _) = self
            .transformer
            .forward(tokens, sequences, &Dropout::none());
        self.head.rewards(h)
    }

    /// The reward of the last step of every window of full length that slides over one long clip, `[1, windows, 1]`, where
    /// there is a quick way.
    pub(super) fn sliding_rewards(&self, clip: &Clips) -> Option<Tensor<3>> {
        let inputs = vec![clip.actions.clone(), clip.observations.clone()];
        let h = self.transformer.slide(&self.embedding, inputs)?;
        Some(self.head.rewards(h))
    }

    /// The reward of every step, `[1, clips * steps, 1]`, from those of its clip before it.
    pub(super) fn rewards(&self, clips: &Clips) -> Tensor<3> {
        let (tokens, _) = self.tokens(clips);
        let sequences = sequences(clips, STATE);
        let (h, _) = self
            .transformer
            .forward(tokens, sequences, &Dropout::none());
        self.head.rewards(h)
    }

    /// Gradients of the parameters from the gradient in the scores.
    pub(super) fn gradients(&self, tape: NetworkTape, d_scores: Tensor<3>) -> Self {
        let (head, d_h) = self.head.backward(tape.head, d_scores);
        let (transformer, d_tokens) = self.transformer.backward(tape.transformer, d_h);
        let (embedding, _) = self.embedding.backward(tape.embedding, d_tokens);
        Self {
            embedding,
            transformer,
            head,
        }
    }

    /// Tokens `[1, clips * 2 steps, width]`: of every step its action, then its state.
    fn tokens(&self, clips: &Clips) -> (Tensor<3>, EmbeddingTape) {
        let inputs = vec![clips.actions.clone(), clips.observations.clone()];
        self.embedding.forward(inputs, vec![0; clips.count])
    }
}

fn sequences(clips: &Clips, readout: Readout) -> Sequences {
    Sequences {
        count: clips.count,
        tokens: 2 * clips.steps(),
        readout,
    }
}
