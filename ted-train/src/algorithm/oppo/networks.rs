//! The hindsight encoder and the policy.

use burn::tensor::Tensor;
use rand::Rng;

use crate::nn::transformer::{
    Dropout, Embedding, EmbeddingTape, Readout, Sequences, Tape, Transformer, TransformerShape,
    backward, dense, forward, tensors,
};
use crate::nn::{Backend, Linear};

use super::config::OppoConfig;

/// Equally long clips, one after the other.
#[derive(Clone, Debug)]
pub(super) struct Clips {
    /// `[1, clips * steps, observation]`, standardised.
    pub(super) observations: Tensor<3>,
    /// `[1, clips * steps, action]`.
    pub(super) actions: Tensor<3>,
    /// Number of the first step of each clip in its episode.
    pub(super) starts: Vec<usize>,
}

impl Clips {
    fn rows(&self) -> usize {
        self.actions.dims()[1]
    }

    fn steps(&self) -> usize {
        self.rows() / self.starts.len()
    }

    /// All tokens, of which a step has `kinds`.
    fn sequences(&self, kinds: usize) -> Sequences {
        Sequences {
            count: self.starts.len(),
            tokens: kinds * self.steps(),
            readout: Readout::ALL,
        }
    }
}

/// Widths of what the networks see: observation, action, and steps of the longest episode.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inputs {
    pub(super) observation: usize,
    pub(super) action: usize,
    pub(super) numbers: usize,
}

fn shape(config: &OppoConfig, causal: bool) -> TransformerShape {
    TransformerShape {
        width: config.width,
        layers: config.layers,
        heads: config.heads,
        causal,
    }
}

/// From a clip to its latent. Also the type of its gradients, as is the policy.
#[derive(Clone, Debug)]
pub(super) struct Encoder {
    embedding: Embedding,
    transformer: Transformer,
    latent: Linear,
}

/// What the backward pass needs.
pub(super) struct EncoderTape {
    embedding: EmbeddingTape,
    transformer: Tape,
    sums: Tensor<3>,
    tokens: usize,
}

impl Encoder {
    pub(super) fn new(
        config: &OppoConfig,
        inputs: Inputs,
        rng: &mut impl Rng,
        backend: Backend,
    ) -> Self {
        let (device, width) = (backend.device(), config.width);
        let kinds = [inputs.observation, inputs.action];
        Self {
            embedding: Embedding::new(&kinds, inputs.numbers, width, rng, &device),
            transformer: Transformer::new(&shape(config, false), rng, &device),
            latent: dense(width, config.latent, rng, &device),
        }
    }

    /// Every parameter, always in the same order.
    pub(super) fn tensors(&mut self) -> Vec<&mut Tensor<3>> {
        let mut all = self.embedding.tensors();
        all.extend(self.transformer.tensors());
        all.extend(tensors(&mut self.latent));
        all
    }

    /// Latents `[1, clips, latent]`.
    pub(super) fn forward(&self, clips: &Clips, dropout: &Dropout) -> (Tensor<3>, EncoderTape) {
        let inputs = vec![clips.observations.clone(), clips.actions.clone()];
        let (x, embedding) = self.embedding.forward(inputs, clips.starts.clone());
        let sequences = clips.sequences(2);
        let (h, transformer) = self.transformer.forward(x, sequences, dropout);
        let [_, _, width] = h.dims();
        let Sequences { count, tokens, .. } = sequences;
        let sums = h.reshape([count, tokens, width]).sum_dim(1);
        let sums = sums.reshape([1, count, width]);
        let latents = forward(&self.latent, sums.clone(), false);
        let tape = EncoderTape {
            embedding,
            transformer,
            sums,
            tokens,
        };
        (latents, tape)
    }

    pub(super) fn backward(&self, tape: EncoderTape, d_latents: Tensor<3>) -> Self {
        let (latent, d_sums) = backward(&self.latent, tape.sums, d_latents);
        let [_, count, width] = d_sums.dims();
        let d_h = d_sums.reshape([count, 1, width]);
        let d_h = d_h.expand([count, tape.tokens, width]);
        let d_h = d_h.reshape([1, count * tape.tokens, width]);
        let (transformer, d_x) = self.transformer.backward(tape.transformer, d_h);
        let (embedding, _) = self.embedding.backward(tape.embedding, d_x);
        Self {
            embedding,
            transformer,
            latent,
        }
    }
}

/// From a latent and what was seen and done to the next action; and, to learn more from a clip, to the observation
/// without its noise.
#[derive(Clone, Debug)]
pub(super) struct Policy {
    embedding: Embedding,
    transformer: Transformer,
    action: Linear,
    observation: Linear,
}

/// What the policy says of every step.
pub(super) struct Prediction {
    /// `[1, clips * steps, action]`, in (-1, 1).
    pub(super) actions: Tensor<3>,
    /// `[1, clips * steps, observation]`.
    pub(super) observations: Tensor<3>,
}

/// What the backward pass needs.
pub(super) struct PolicyTape {
    embedding: EmbeddingTape,
    transformer: Tape,
    at_observation: Tensor<3>,
    at_action: Tensor<3>,
    actions: Tensor<3>,
    clips: usize,
}

/// A step's tokens are latent, observation, action.
const KINDS: usize = 3;
const AT_OBSERVATION: Readout = Readout {
    group: KINDS,
    offset: 1,
};
const AT_ACTION: Readout = Readout {
    group: KINDS,
    offset: 2,
};

impl Policy {
    pub(super) fn new(
        config: &OppoConfig,
        inputs: Inputs,
        rng: &mut impl Rng,
        backend: Backend,
    ) -> Self {
        let (device, width) = (backend.device(), config.width);
        let kinds = [config.latent, inputs.observation, inputs.action];
        Self {
            embedding: Embedding::new(&kinds, inputs.numbers, width, rng, &device),
            transformer: Transformer::new(&shape(config, true), rng, &device),
            action: dense(width, inputs.action, rng, &device),
            observation: dense(width, inputs.observation, rng, &device),
        }
    }

    /// Every parameter, always in the same order.
    pub(super) fn tensors(&mut self) -> Vec<&mut Tensor<3>> {
        let mut all = self.embedding.tensors();
        all.extend(self.transformer.tensors());
        all.extend(tensors(&mut self.action));
        all.extend(tensors(&mut self.observation));
        all
    }

    /// Predictions for clips with one latent each, `[1, clips, latent]`.
    pub(super) fn forward(
        &self,
        latents: Tensor<3>,
        clips: &Clips,
        dropout: &Dropout,
    ) -> (Prediction, PolicyTape) {
        let [_, count, size] = latents.dims();
        let latents = latents.reshape([count, 1, size]);
        let latents = latents.expand([count, clips.steps(), size]);
        let latents = latents.reshape([1, clips.rows(), size]);
        let inputs = vec![latents, clips.observations.clone(), clips.actions.clone()];
        let (x, embedding) = self.embedding.forward(inputs, clips.starts.clone());
        let sequences = clips.sequences(KINDS);
        let (h, transformer) = self.transformer.forward(x, sequences, dropout);
        let at_observation = AT_OBSERVATION.pick(h.clone());
        let at_action = AT_ACTION.pick(h);
        let prediction = Prediction {
            actions: forward(&self.action, at_observation.clone(), false).tanh(),
            observations: forward(&self.observation, at_action.clone(), false),
        };
        let tape = PolicyTape {
            embedding,
            transformer,
            at_observation,
            at_action,
            actions: prediction.actions.clone(),
            clips: count,
        };
        (prediction, tape)
    }

    /// Gradients of the parameters, and the gradient in the latents, `[1, clips, latent]`.
    pub(super) fn backward(&self, tape: PolicyTape, d: Prediction) -> (Self, Tensor<3>) {
        let slope = (tape.actions.clone() * tape.actions).neg().add_scalar(1.0);
        let (action, d_h1) = backward(&self.action, tape.at_observation, d.actions * slope);
        let (observation, d_h2) = backward(&self.observation, tape.at_action, d.observations);
        let d_h = AT_OBSERVATION.spread(d_h1) + AT_ACTION.spread(d_h2);
        let (transformer, d_x) = self.transformer.backward(tape.transformer, d_h);
        let (embedding, d_sums) = self.embedding.backward(tape.embedding, d_x);
        let d_latents = self.embedding.input_gradient(0, d_sums[0].clone());
        let [_, rows, size] = d_latents.dims();
        let d_latents = d_latents
            .reshape([tape.clips, rows / tape.clips, size])
            .sum_dim(1)
            .reshape([1, tape.clips, size]);
        let gradients = Self {
            embedding,
            transformer,
            action,
            observation,
        };
        (gradients, d_latents)
    }
}
