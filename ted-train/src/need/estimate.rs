//! About how many bytes a run takes beside its dataset. The factors were measured, as the largest resident set of `ted train` with one
//! number large: what is said is 1.1 to 2 times that.

use crate::algorithm::AlgorithmConfig;
use crate::algorithm::oppo::OppoConfig;
use crate::config::Config;
use crate::dataset::{Clip, Dataset};
use crate::reward::RewardConfig;
use crate::reward::episodes::{EpisodesConfig, Fitting};
use crate::reward::oprl::OprlConfig;
use crate::reward::transformer::PtConfig;

/// What decides it of the logs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Logs<'a> {
    pub id: &'a str,
    pub observation: f64,
    pub action: f64,
    pub steps: f64,
    pub episodes: f64,
    pub longest: f64,
}

impl<'a> Logs<'a> {
    pub fn of(dataset: &'a Dataset) -> Self {
        let longest = dataset.episodes().iter().map(|it| it.len).max();
        Self {
            id: dataset.id(),
            observation: dataset.observation_dim() as f64,
            action: dataset.action_dim() as f64,
            steps: dataset.step_count() as f64,
            episodes: dataset.episodes().len() as f64,
            longest: longest.unwrap_or(0) as f64,
        }
    }
}

/// Bytes of a number of single precision.
const F32: f64 = 4.0;
/// A row of a batch is there as what a layer gives, its gradient, and what the two are made from.
const COPIES: f64 = 3.0;
/// The ensemble of rewards learns from all rows at once, by tensor operations that keep what they are given.
const KEPT_BY_ENSEMBLE: f64 = 8.0;
/// What is kept of an episode that was flown.
const FLOWN: f64 = 512.0;
/// A pair of segments, what is predicted of both, and its place in a ranking.
const PAIR: f64 = 128.0;

/// Bytes of everything.
pub(super) fn bytes(config: &Config, logs: &Logs<'_>) -> f64 {
    let reward = match &config.reward {
        RewardConfig::Oprl(config) => oprl(config, logs),
        RewardConfig::Transformer(config) => transformer(config, logs),
        RewardConfig::Episodes(config) => episodes(config, logs),
        RewardConfig::None {}
        | RewardConfig::True {}
        | RewardConfig::Zero {}
        | RewardConfig::Random {}
        | RewardConfig::Negative {}
        | RewardConfig::Transport(_) => 0.0,
    };
    // Rewards, discounts, conditions, and observations on the scale of a network.
    let labels = logs.steps * (logs.observation + 8.0) * F32;
    let flights = f64::from(config.schedule.evaluation_episodes) * FLOWN;
    reward + labels + flights + algorithm(&config.algorithm, logs)
}

fn algorithm(config: &AlgorithmConfig, logs: &Logs<'_>) -> f64 {
    // How many of its networks have their rows in memory at the same time.
    let (hidden, networks) = match config {
        AlgorithmConfig::Iql(config) => (&config.hidden, 3.5),
        AlgorithmConfig::Atac(config) => (&config.hidden, 6.0),
        AlgorithmConfig::Awr(config) => (&config.hidden, 2.5),
        AlgorithmConfig::Bc(config) => (&config.hidden, 1.0),
        AlgorithmConfig::Conditioned(config) => (&config.hidden, 1.0),
        AlgorithmConfig::Oppo(config) => return oppo(config, logs),
    };
    let drawn = 2.0 * logs.observation + logs.action + 4.0;
    let row = networks * row(logs.observation + logs.action + 1.0, hidden) + drawn;
    config.batch() as f64 * row * F32
}

/// Numbers of one row of a batch in a perceptron.
fn row(inputs: f64, hidden: &[usize]) -> f64 {
    COPIES * (inputs + hidden.iter().sum::<usize>() as f64 + 1.0)
}

fn oprl(config: &OprlConfig, logs: &Logs<'_>) -> f64 {
    let segment = match config.segment {
        Clip::Steps(steps) => f64::from(steps).min(logs.longest),
        Clip::Episode => logs.longest,
    };
    let (members, answers) = (config.members as f64, 1.0 + f64::from(config.rounds));
    let row = row(logs.observation + logs.action, &config.hidden);
    let training = members * answers * 2.0 * segment * row * F32;
    KEPT_BY_ENSEMBLE * training + (config.pool as f64 + config.held_out as f64) * PAIR
}

fn episodes(config: &EpisodesConfig, logs: &Logs<'_>) -> f64 {
    let fit = |fitting: &Fitting| {
        fitting.batch as f64 * row(logs.observation + logs.action, &fitting.hidden) * F32
    };
    let fits = fit(&config.clone).max(fit(&config.network));
    let candidates = (config.candidates as f64).min(logs.episodes);
    let sample = 2.0 * logs.episodes + candidates + 2.0 * logs.observation;
    let samples = config.samples as f64 * sample * 8.0;
    fits + samples + (config.pool as f64 + config.held_out as f64) * PAIR
}

fn transformer(config: &PtConfig, logs: &Logs<'_>) -> f64 {
    /// Clips of held-out pairs that are looked at together.
    const HELD_OUT: f64 = 40.0;
    let clips = (2.0 * config.queries as f64).max(HELD_OUT);
    let steps = f64::from(config.segment).min(logs.longest);
    let blocks = Blocks {
        width: config.width as f64,
        layers: config.layers as f64,
        heads: config.heads as f64,
    };
    blocks.parameters(steps) + blocks.clips(clips, 2.0 * steps) + config.held_out as f64 * PAIR
}

fn oppo(config: &OppoConfig, logs: &Logs<'_>) -> f64 {
    let steps = f64::from(config.segment).min(logs.longest);
    let blocks = Blocks {
        width: config.width as f64,
        layers: config.layers as f64,
        heads: config.heads as f64,
    };
    let clips = (config.batch as f64).max(2.0 * config.queries as f64);
    let latents = (clips + 10.0 * blocks.width) * config.latent as f64 * F32;
    // An encoder and a policy, one after the other.
    2.0 * blocks.parameters(logs.longest) + latents + 2.0 * blocks.clips(clips, 3.0 * steps)
}

/// The blocks of a transformer.
struct Blocks {
    width: f64,
    layers: f64,
    heads: f64,
}

impl Blocks {
    /// Weights, their gradients, and the two means and the copy of an optimiser.
    fn parameters(&self, places: f64) -> f64 {
        5.0 * (12.0 * self.layers * self.width * self.width + places * self.width) * F32
    }

    /// Clips of so many tokens, forward and backward.
    fn clips(&self, clips: f64, tokens: f64) -> f64 {
        let of_width = 16.0 * tokens * self.width;
        let of_attention = 3.0 * self.heads * tokens * tokens;
        clips * self.layers * (of_width + of_attention) * F32
    }
}
