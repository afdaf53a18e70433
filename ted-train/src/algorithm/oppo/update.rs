//! The whole update on one screen, and what it needs.

use burn::tensor::{Tensor, TensorData};
use rand::Rng;
use serde::Serialize;

use crate::dataset::{Clip, Dataset, Segment, SegmentError, SegmentSampler};
use crate::nn::transformer::Dropout;
use crate::nn::{AdamWState, Backend};
use crate::preferences::LabelledPair;
use crate::reward::InputScaling;
use crate::rng::{Seed, standard_normal};

use super::config::OppoConfig;
use super::losses::{excess_length, squared_error, triplet};
use super::networks::{Clips, Encoder, Inputs, Policy, Prediction};

/// The learner: both transformers, the latent, and their optimisers.
#[derive(Clone, Debug)]
pub struct Oppo {
    pub(super) config: OppoConfig,
    pub(super) encoder: Encoder,
    pub(super) policy: Policy,
    /// `[1, 1, latent]`: the behaviour that people prefer.
    pub(super) latent: Tensor<3>,
    pub(super) encoder_adam: AdamWState,
    pub(super) policy_adam: AdamWState,
    pub(super) latent_adam: AdamWState,
    /// Steps of the encoder's optimiser and of the policy's; the latent's are the updates.
    pub(super) steps: [u64; 2],
    pub(super) step: u64,
    pub(super) inputs: Inputs,
    sampler: SegmentSampler,
    shift: Vec<f32>,
    scale: Vec<f32>,
    pub(super) backend: Backend,
    seed: Seed,
}

/// Losses of an update's second part, which every update has, before the encoder moved.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct UpdateLosses {
    /// How well the policy continues the labelled clips, from their own latents.
    pub reconstruction_loss: f32,
    /// How well the latents of the labelled clips are ordered by their distance to the latent.
    pub preference_loss: f32,
    /// How far the labelled clips' latents are longer than 1.
    pub norm_loss: f32,
}

impl Oppo {
    /// Fresh networks and a latent from N(0, 1), each from a stream of its own.
    ///
    /// # Errors
    /// When the dataset has no clip of the length asked for.
    ///
    /// # Panics
    /// When the width is no multiple of the heads, which the check of a configuration refuses.
    pub fn new(
        config: &OppoConfig,
        dataset: &Dataset,
        seed: Seed,
        backend: Backend,
    ) -> Result<Self, SegmentError> {
        assert!(
            config.width.is_multiple_of(config.heads),
            "heads share the width equally"
        );
        let inputs = Inputs {
            observation: dataset.observation_dim(),
            action: dataset.action_dim(),
            numbers: dataset.episodes().iter().map(|e| e.len).max().unwrap_or(0),
        };
        let mut encoder = Encoder::new(config, inputs, &mut seed.child("encoder").rng(), backend);
        let mut policy = Policy::new(config, inputs, &mut seed.child("policy").rng(), backend);
        let rng = &mut seed.child("latent").rng();
        let mut latent = normals([1, 1, config.latent], 1.0, rng, backend);
        // The original adds 1e-6 to the deviation; a floor does the same and is what rewards use.
        let scaling = InputScaling::Standard { floor: 1e-3 };
        let [shift, scale] = scaling.shift_and_scale(&dataset.observation_statistics());
        Ok(Self {
            sampler: SegmentSampler::new(dataset, Clip::Steps(config.segment))?,
            encoder_adam: AdamWState::new(encoder.tensors()),
            policy_adam: AdamWState::new(policy.tensors()),
            latent_adam: AdamWState::new(vec![&mut latent]),
            config: config.clone(),
            encoder,
            policy,
            latent,
            steps: [0; 2],
            step: 0,
            inputs,
            shift,
            scale,
            backend,
            seed,
        })
    }

    /// Updates made.
    #[must_use]
    pub fn step(&self) -> u64 {
        self.step
    }

    /// One update: the policy and the encoder continue clips of the dataset, the encoder orders the labelled ones, and the
    /// latent moves to where the better ones are.
    pub fn update(&mut self, dataset: &Dataset, pairs: &[LabelledPair]) -> UpdateLosses {
        self.backend.run(|| self.update_here(dataset, pairs))
    }

    fn update_here(&mut self, dataset: &Dataset, pairs: &[LabelledPair]) -> UpdateLosses {
        if self.step.is_multiple_of(2) {
            let mut rng = self.seed.child("batch").rng_at(self.step);
            let batch: Vec<Segment> = (0..self.config.batch)
                .map(|_| self.sampler.sample(&mut rng))
                .collect();
            let clips = self.clips(dataset, &batch);
            let noisy = self.noisy(&clips);
            let (z, encoded) = self.encoder.forward(&clips, &self.dropout("clips"));
            let (prediction, tape) = self.policy.forward(z, &noisy, &self.dropout("policy"));
            let (_, d) = reconstruction(prediction, &clips);
            let (policy, d_z) = self.policy.backward(tape, d);
            let encoder = self.encoder.backward(encoded, d_z);
            self.step_policy(policy);
            self.step_encoder(encoder);
        }

        let labels: Vec<f32> = pairs.iter().map(|pair| pair.label).collect();
        let side = |side: usize| pairs.iter().map(move |pair| pair.segments[side]);
        let both: Vec<Segment> = side(0).chain(side(1)).collect();
        let clips = self.clips(dataset, &both);
        let anchor = numbers(&self.latent);
        let (z, encoded) = self.encoder.forward(&clips, &self.dropout("pairs"));
        let latents = numbers(&z);
        let preferred = triplet(&anchor, &latents, &labels, self.config.margin);
        let (norm, d_norm) = excess_length(&latents, anchor.len());
        let (prediction, tape) = self.policy.forward(z, &clips, &self.dropout("judge"));
        let (reconstruction_loss, d) = reconstruction(prediction, &clips);
        let (_, d_z) = self.policy.backward(tape, d);
        // The original adds the means over the first clips and over the second ones; this is the mean over both.
        let d_z = d_z.mul_scalar(2.0);
        let weights = [self.config.preference_weight, self.config.norm_weight];
        let d_latents = preferred.d_latents.iter().zip(&d_norm);
        let d_latents = d_latents.map(|(p, n)| weights[0] as f32 * p + weights[1] as f32 * n);
        let d_latents = TensorData::new(d_latents.collect(), d_z.dims());
        let d_z = d_z + Tensor::from_data(d_latents, &self.backend.device());
        let encoder = self.encoder.backward(encoded, d_z);
        self.step_encoder(encoder);

        let (z, _) = self.encoder.forward(&clips, &self.dropout("latent"));
        let moved = triplet(&anchor, &numbers(&z), &labels, self.config.margin);
        self.step += 1;
        let gradient = TensorData::new(moved.d_anchor, [1, 1, anchor.len()]);
        self.config.adamw.step(
            vec![&mut self.latent],
            &mut self.latent_adam,
            vec![&mut Tensor::from_data(gradient, &self.backend.device())],
            self.config.latent_rate,
            self.step,
        );
        UpdateLosses {
            reconstruction_loss,
            preference_loss: preferred.loss,
            norm_loss: norm,
        }
    }

    /// The segments as the networks see them.
    pub(super) fn clips(&self, dataset: &Dataset, segments: &[Segment]) -> Clips {
        let steps = || segments.iter().flat_map(|s| s.steps(dataset));
        let observations = steps().flat_map(|step| self.standardised(dataset.observation(step)));
        let actions = steps().flat_map(|step| dataset.action(step).iter().copied());
        let rows = steps().count();
        let tensor = |values: Vec<f32>, width| -> Tensor<3> {
            Tensor::from_data(
                TensorData::new(values, [1, rows, width]),
                &self.backend.device(),
            )
        };
        Clips {
            observations: tensor(observations.collect(), dataset.observation_dim()),
            actions: tensor(actions.collect(), dataset.action_dim()),
            starts: segments.iter().map(|s| s.start() as usize).collect(),
        }
    }

    /// An observation as the networks see it.
    pub(super) fn standardised<'a>(&'a self, raw: &'a [f32]) -> impl Iterator<Item = f32> + 'a {
        let map = self.shift.iter().zip(&self.scale);
        raw.iter()
            .zip(map)
            .map(|(raw, (shift, scale))| (raw - shift) * scale)
    }

    fn noisy(&self, clips: &Clips) -> Clips {
        let rng = &mut self.seed.child("noise").rng_at(self.step);
        let noise = normals(
            clips.observations.dims(),
            self.config.noise,
            rng,
            self.backend,
        );
        Clips {
            observations: clips.observations.clone() + noise,
            ..clips.clone()
        }
    }

    /// What a pass of this update drops.
    fn dropout(&self, pass: &str) -> Dropout {
        let stream = self.seed.child("dropout").child(pass);
        Dropout::of_update(self.config.dropout, stream, self.step, 1)
    }

    fn step_policy(&mut self, mut gradients: Policy) {
        let warmed = (self.step + 1) as f64 / self.config.warmup.max(1) as f64;
        let rate = self.config.learning_rate * warmed.min(1.0);
        clip(gradients.tensors(), self.config.clip);
        self.steps[1] += 1;
        let (parameters, gradients) = (self.policy.tensors(), gradients.tensors());
        let adamw = self.config.adamw;
        adamw.step(
            parameters,
            &mut self.policy_adam,
            gradients,
            rate,
            self.steps[1],
        );
    }

    fn step_encoder(&mut self, mut gradients: Encoder) {
        clip(gradients.tensors(), self.config.clip);
        self.steps[0] += 1;
        let (parameters, gradients) = (self.encoder.tensors(), gradients.tensors());
        let (adamw, rate) = (self.config.adamw, self.config.learning_rate);
        adamw.step(
            parameters,
            &mut self.encoder_adam,
            gradients,
            rate,
            self.steps[0],
        );
    }
}

/// Mean squared errors of actions and observations, and their gradients.
fn reconstruction(prediction: Prediction, clips: &Clips) -> (f32, Prediction) {
    let (of_actions, actions) = squared_error(prediction.actions, clips.actions.clone());
    let target = clips.observations.clone();
    let (of_observations, observations) = squared_error(prediction.observations, target);
    let d = Prediction {
        actions,
        observations,
    };
    (of_actions + of_observations, d)
}

/// Shortens a gradient that is longer than `limit`.
pub(super) fn clip(mut gradients: Vec<&mut Tensor<3>>, limit: f32) {
    // In order, whatever the number of threads.
    let square = |g: &Tensor<3>| numbers(g).iter().map(|x| f64::from(x * x)).sum::<f64>();
    let length = gradients.iter().map(|g| square(g)).sum::<f64>().sqrt() as f32;
    if length > limit {
        for gradient in &mut gradients {
            **gradient = gradient.clone().mul_scalar(limit / length);
        }
    }
}

fn normals(shape: [usize; 3], std: f32, rng: &mut impl Rng, backend: Backend) -> Tensor<3> {
    let count = shape.iter().product::<usize>();
    let values = (0..count).map(|_| std * standard_normal(rng) as f32);
    Tensor::from_data(TensorData::new(values.collect(), shape), &backend.device())
}

pub(super) fn numbers(tensor: &Tensor<3>) -> Vec<f32> {
    let numbers = tensor.to_data().try_to_vec();
    numbers.expect("a float tensor holds f32")
}
