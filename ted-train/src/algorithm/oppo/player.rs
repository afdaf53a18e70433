//! The policy at work: it keeps what it has seen and done, and continues it as people prefer.

use burn::tensor::{Tensor, TensorData};

use crate::nn::transformer::Dropout;

use super::networks::Clips;
use super::update::{Oppo, numbers};

/// A trained policy in one episode.
#[derive(Clone, Debug)]
pub struct Player<'a> {
    oppo: &'a Oppo,
    /// Standardised observations of the last steps, the present one included.
    observations: Vec<f32>,
    /// Actions of the last steps.
    actions: Vec<f32>,
    /// Steps taken.
    step: usize,
}

impl<'a> Player<'a> {
    /// At the start of an episode.
    #[must_use]
    pub fn new(oppo: &'a Oppo) -> Self {
        Self {
            oppo,
            observations: Vec::new(),
            actions: Vec::new(),
            step: 0,
        }
    }

    /// Starts another episode.
    pub fn reset(&mut self) {
        *self = Self::new(self.oppo);
    }

    /// The action in (-1, 1) for the next observation, from it and the steps before it, as many as a clip has. Episodes
    /// that go on longer than the longest of the dataset keep its last number.
    pub fn act(&mut self, observation_raw: &[f32]) -> Vec<f32> {
        let width = observation_raw.len();
        let size = self.oppo.inputs.action;
        let limit = self.oppo.config.segment as usize;
        if self.observations.len() == limit * width {
            self.observations.drain(..width);
            self.actions.drain(..size);
        }
        self.observations
            .extend(self.oppo.standardised(observation_raw));
        let steps = self.observations.len() / width;
        let device = self.oppo.backend.device();
        // The action that is to come is not seen by the token that predicts it.
        let actions = [&self.actions[..], &vec![0.0; size]].concat();
        let tensor = |values: Vec<f32>, width| -> Tensor<3> {
            Tensor::from_data(TensorData::new(values, [1, steps, width]), &device)
        };
        let start = (self.step + 1 - steps).min(self.oppo.inputs.numbers - steps);
        let clips = Clips {
            observations: tensor(self.observations.clone(), width),
            actions: tensor(actions, size),
            starts: vec![start],
        };
        let latent = self.oppo.latent.clone();
        let (prediction, _) = self.oppo.policy.forward(latent, &clips, &Dropout::none());
        let actions = numbers(&prediction.actions);
        let action = actions[(steps - 1) * size..].to_vec();
        self.actions.extend_from_slice(&action);
        self.step += 1;
        action
    }
}
