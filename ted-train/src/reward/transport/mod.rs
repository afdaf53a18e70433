//! OTR (Luo, Jiang, Cohen, Grefenstette, Deisenroth 2023): a step is worth as much as it costs little to carry it to an expert
//! episode.
//!
//! ```text
//! P     = argmin over P with row sums 1/T and column sums 1/T' of  sum_tj P_tj C_tj + epsilon sum_tj P_tj log P_tj
//! c_t   = T sum_j P_tj C_tj                      mean cost of what step t of the episode is carried to
//! r_t   = alpha exp(-beta c_t / d)
//! ```
//!
//! `C_tj` is the cost between observation `t` of an episode of `T` steps and observation `j` of an expert episode of `T'`; `d` is
//! the number of values in an observation. With several experts, an episode has the rewards of the expert under which they
//! sum to the most. No action is looked at, and no true reward but the returns that choose the experts.
//!
//! | choice | ours | original (ethanluoyc/optimal_transport_reward) | paper |
//! |---|---|---|---|
//! | experts | the 10 episodes of the highest true return | the same; 1 and 10 in its sweep (`configs/otr_iql_mujoco.py`) | "several expert demonstrations" |
//! | cost | cosine, or Euclidean | cosine | "optimal transport distances" |
//! | observations | raw, or standardised over the dataset | raw (`train_offline.py` passes no preprocessor); a running standardisation exists | not stated |
//! | epsilon, iterations | 0.01, at most 100 | the same (`agents/otil/rewarder.py`) | not stated |
//! | an iteration | columns, then rows | the same (`ott-jax` 0.2.11) | not stated |
//! | start | smallest cost of each row | zero | not stated |
//! | stop | column sums off by [`CONVERGED`] in all, looked at after every iteration | 1e-9 in single precision, after every tenth | not stated |
//! | weights of steps | 1/T and 1/T': lengths do not matter | 1/1000 each, whatever the length | not stated |
//! | `T` in the reward | the episode's own | 1000 | not stated |
//! | squashing | `alpha = beta = 5` | the same | not stated |
//! | several experts | the one with the largest sum | the same | not stated |
//! | scale | mapped to [0, 1] over the dataset, like every reward | 1000 / (largest - smallest return) | not stated |
//!
//! Where all episodes have 1000 steps, both columns weigh and squash the same.

mod config;
mod cost;
mod sinkhorn;
#[cfg(test)]
mod tests;

pub use config::{Cost, TransportConfig};
pub use sinkhorn::CONVERGED;

use firmware_sim::interrupt;
use firmware_sim::progress::Audience;
use rayon::prelude::*;

use crate::dataset::{Dataset, Episode};
use crate::ranking::ranking;

use cost::{Expert, Metric};

/// A reward that cannot be computed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TransportError {
    /// There are not that many episodes to imitate.
    #[error("reward.experts is {experts}, expected 1 to {episodes}, the episodes of the dataset")]
    Experts {
        /// Experts asked for.
        experts: usize,
        /// Episodes of the dataset.
        episodes: usize,
    },
    /// Somebody asked to stop.
    #[error(
        "stopped before every episode was carried to the best ones; the same command begins that again"
    )]
    Interrupted,
    /// An episode so far from every expert that single precision has no number for it.
    #[error(
        "a reward of episode {episode} is not a finite number: set reward.scaling.kind to \"standard\", \
         or raise reward.epsilon"
    )]
    NotFinite {
        /// Number of the episode.
        episode: usize,
    },
}

/// Whether the dataset has that many experts.
///
/// # Errors
/// When it has fewer episodes, or none is asked for.
pub fn check(dataset: &Dataset, config: &TransportConfig) -> Result<(), TransportError> {
    let (experts, episodes) = (config.experts, dataset.episodes().len());
    if (1..=episodes).contains(&experts) {
        Ok(())
    } else {
        Err(TransportError::Experts { experts, episodes })
    }
}

/// The raw reward of each transition, in (0, alpha]: a function of the dataset alone.
///
/// # Errors
/// When [`check`] does, when a cost leaves the range of single precision, and when
/// somebody asks to stop.
pub fn transport_labels(
    dataset: &Dataset,
    config: &TransportConfig,
    audience: Audience,
) -> Result<Vec<f32>, TransportError> {
    check(dataset, config)?;
    let episodes = dataset.episodes();
    let returns: Vec<f64> = episodes.iter().map(|e| e.return_true).collect();
    let mut experts = ranking(&returns);
    experts.truncate(config.experts);
    let metric = Metric::new(dataset, config);
    let experts: Vec<Expert> = experts
        .iter()
        .map(|&i| metric.expert(dataset, &episodes[i]))
        .collect();
    let count = episodes.len() as u64;
    let progress = audience.start("carry episodes to the best ones", count, "episodes");
    let rewards: Vec<Vec<f32>> = episodes
        .par_iter()
        .enumerate()
        .map(|(index, episode)| {
            if interrupt::requested() {
                return Err(TransportError::Interrupted);
            }
            let rewards = rewards(dataset, config, &metric, &experts, episode);
            progress.advance(1);
            let finite = rewards.iter().all(|r| r.is_finite());
            finite
                .then_some(rewards)
                .ok_or(TransportError::NotFinite { episode: index })
        })
        .collect::<Result<_, _>>()?;
    progress.finish();
    Ok(rewards.concat())
}

/// The rewards of an episode under the expert that it is closest to; between equal ones, the better expert.
fn rewards(
    dataset: &Dataset,
    config: &TransportConfig,
    metric: &Metric,
    experts: &[Expert],
    episode: &Episode,
) -> Vec<f32> {
    let points = metric.points(dataset, episode);
    let rate = config.beta / dataset.observation_dim() as f64;
    let mut best = (f64::NEG_INFINITY, vec![f32::NAN; episode.len]);
    for expert in experts {
        let costs = metric.costs(&points, expert);
        let plan = sinkhorn::plan(&costs, expert.len, config.epsilon as f32, config.iterations);
        let rewards: Vec<f64> = plan
            .mean_costs(&costs)
            .map(|cost| config.alpha * libm::exp(-rate * cost))
            .collect();
        let sum = rewards.iter().sum();
        if sum > best.0 {
            best = (sum, rewards.into_iter().map(|r| r as f32).collect());
        }
    }
    best.1
}
