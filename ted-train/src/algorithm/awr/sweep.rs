//! A pass over the whole dataset at the beginning of each phase: what V is trained towards, or what each transition weighs.
//!
//! Its numbers follow from the dataset and one state of V, so a checkpoint holds that state instead of them.

use burn::tensor::{Device, Tensor, TensorData};

use crate::algorithm::Replay;
use crate::nn::Mlp;

use super::{AwrConfig, advantage_weights, lambda_returns};

/// Observations that go through V together.
const CHUNK: usize = 4096;

/// A number for each transition of each lane's dataset.
#[derive(Clone)]
pub(super) struct Sweep {
    /// The update it was made for: the first of its phase.
    pub(super) begins: u64,
    labels: Vec<Vec<f32>>,
}

impl Sweep {
    /// Targets of the network of V: TD(lambda) returns over the value scale.
    pub(super) fn targets(
        begins: u64,
        critic: &Mlp,
        replays: &[&Replay<'_>],
        config: &AwrConfig,
        device: &Device,
    ) -> Self {
        let of_lane = |(lane, replay): (usize, &&Replay<'_>)| {
            let values = values(&critic.member(lane), replay, config, device);
            let returns = returns(replay, &values, config.lambda).into_iter();
            let target = |(_, r)| (r / config.value_scale) as f32;
            returns.map(target).collect()
        };
        let labels = replays.iter().enumerate().map(of_lane).collect();
        Self { begins, labels }
    }

    /// Weights of the transitions in the regression.
    pub(super) fn weights(
        begins: u64,
        critic: &Mlp,
        replays: &[&Replay<'_>],
        config: &AwrConfig,
        device: &Device,
    ) -> Self {
        let of_lane = |(lane, replay): (usize, &&Replay<'_>)| {
            let values = values(&critic.member(lane), replay, config, device);
            let returns = returns(replay, &values, config.lambda).into_iter();
            let advantages: Vec<_> = returns.map(|(v, r)| r - f64::from(v)).collect();
            let (temperature, clip) = (config.temperature, config.weight_clip);
            advantage_weights(&advantages, replay.kept(), temperature, clip)
        };
        let labels = replays.iter().enumerate().map(of_lane).collect();
        Self { begins, labels }
    }

    /// The numbers of a batch's transitions, lane after lane.
    pub(super) fn of(&self, transitions: &[u32]) -> Vec<f32> {
        let rows = transitions.len() / self.labels.len();
        let lanes = self.labels.iter().zip(transitions.chunks(rows));
        let of_lane = |(labels, rows): (&Vec<f32>, &[u32])| -> Vec<f32> {
            rows.iter().map(|&row| labels[row as usize]).collect()
        };
        lanes.flat_map(of_lane).collect()
    }
}

/// V of every observation of the dataset, row by row.
fn values(critic: &Mlp, replay: &Replay<'_>, config: &AwrConfig, device: &Device) -> Vec<f32> {
    let width = replay.dataset().observation_dim();
    let rows = replay.dataset().observations().len() / width;
    let mut values = Vec::with_capacity(rows);
    for start in (0..rows).step_by(CHUNK) {
        let end = rows.min(start + CHUNK);
        let x = TensorData::new(replay.standardised(start..end), [1, end - start, width]);
        let v = critic.forward(Tensor::from_data(x, device));
        let v = v.mul_scalar(config.value_scale).into_data();
        values.extend_from_slice(v.as_slice().expect("a float tensor holds f32"));
    }
    values
}

/// V and TD(lambda) return of every transition.
fn returns(replay: &Replay<'_>, values: &[f32], lambda: f64) -> Vec<(f32, f64)> {
    let dataset = replay.dataset();
    let of_episode = |episode: &crate::dataset::Episode| -> Vec<_> {
        let steps = episode.first_step..episode.first_step + episode.len;
        let first = dataset.observations_row(episode.first_step);
        let values = &values[first..=first + episode.len];
        let (rewards, discounts) = (&replay.rewards()[steps.clone()], &replay.discounts()[steps]);
        let returns = lambda_returns(rewards, discounts, values, lambda);
        values.iter().copied().zip(returns).collect()
    };
    dataset.episodes().iter().flat_map(of_episode).collect()
}
