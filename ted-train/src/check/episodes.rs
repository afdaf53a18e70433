//! What the episodes of a dataset are: how long, how they end, and which are there twice.

use std::collections::HashMap;

use serde::Serialize;

use crate::dataset::{Dataset, Episode};

/// What its episodes are.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EpisodesCheck {
    /// Steps of the shortest, of the one in the middle, and of the longest.
    pub steps: [usize; 3],
    /// The one reward of every step, if all are the same: then there are none.
    pub only_reward: Option<f32>,
    /// Smallest and largest reward of a step.
    pub rewards: [f32; 2],
    /// Episodes that end the task.
    pub terminated: usize,
    /// Episodes of which only the recording ends.
    pub truncated: usize,
    /// Episodes whose last step says neither.
    pub unflagged: usize,
    /// Episodes with success at some step.
    pub successes: usize,
    /// Episodes that are the same in every observation and action, in groups.
    pub duplicates: Vec<Vec<usize>>,
    /// How many different first observations there are.
    pub beginnings: usize,
    /// Episodes in which every action is the same.
    pub constant_actions: Vec<usize>,
}

impl EpisodesCheck {
    /// Of a dataset.
    pub(super) fn of(dataset: &Dataset) -> Self {
        let episodes = dataset.episodes();
        let mut lengths: Vec<usize> = episodes.iter().map(|it| it.len).collect();
        lengths.sort_unstable();
        let last = |it: &Episode| it.first_step + it.len - 1;
        let ends = |flags: &[bool]| episodes.iter().filter(|it| flags[last(it)]).count();
        let flagged =
            |it: &&Episode| dataset.terminations()[last(it)] || dataset.truncations()[last(it)];
        let rewards = dataset.rewards_true().iter().copied();
        let mut same: HashMap<blake3::Hash, Vec<usize>> = HashMap::new();
        for episode in 0..episodes.len() {
            same.entry(hash(dataset, episode))
                .or_default()
                .push(episode);
        }
        let mut duplicates: Vec<_> = same.into_values().filter(|it| it.len() > 1).collect();
        duplicates.sort();
        let first = |it: &Episode| blake3::hash(bytes(dataset.observation(it.first_step)));
        let mut beginnings: Vec<_> = episodes.iter().map(|it| *first(it).as_bytes()).collect();
        beginnings.sort_unstable();
        beginnings.dedup();
        let constant = (0..episodes.len()).filter(|&episode| {
            let mut rows = actions(dataset, episode).chunks_exact(dataset.action_dim());
            let first = rows.next();
            rows.len() > 0 && rows.all(|row| Some(row) == first)
        });
        Self {
            steps: [
                lengths[0],
                lengths[lengths.len() / 2],
                lengths[lengths.len() - 1],
            ],
            only_reward: dataset.only_reward(),
            rewards: [
                rewards.clone().fold(f32::INFINITY, f32::min),
                rewards.fold(f32::NEG_INFINITY, f32::max),
            ],
            terminated: ends(dataset.terminations()),
            truncated: ends(dataset.truncations()),
            unflagged: episodes.len() - episodes.iter().filter(flagged).count(),
            successes: episodes.iter().filter(|it| it.success).count(),
            duplicates,
            beginnings: beginnings.len(),
            constant_actions: constant.collect(),
        }
    }
}

fn actions(dataset: &Dataset, episode: usize) -> &[f32] {
    let Episode {
        first_step, len, ..
    } = dataset.episodes()[episode];
    let width = dataset.action_dim();
    &dataset.actions()[first_step * width..(first_step + len) * width]
}

/// Of all observations and actions of an episode.
fn hash(dataset: &Dataset, episode: usize) -> blake3::Hash {
    let mut hasher = blake3::Hasher::new();
    hasher.update(bytes(&dataset.observations_recorded(episode)));
    hasher.update(bytes(actions(dataset, episode)));
    hasher.finalize()
}

fn bytes(values: &[f32]) -> &[u8] {
    bytemuck::cast_slice(values)
}
