//! A reward for every transition: that of the last step of the window which ends with it.

use firmware_sim::interrupt;
use firmware_sim::progress::Audience;

use crate::dataset::{Dataset, Episode};
use crate::reward::LearnError;

use super::network::RewardTransformer;
use super::training::numbers;

/// Windows in one forward pass, where each is computed by itself.
const WINDOWS: usize = 64;

/// The raw reward of each transition. Windows have the configured length, and fewer steps where an episode begins.
///
/// # Errors
/// When somebody asks to stop.
pub fn transformer_labels(
    dataset: &Dataset,
    transformer: &RewardTransformer,
    audience: Audience,
) -> Result<Vec<f32>, LearnError> {
    let progress = audience.start("label", dataset.step_count() as u64, "transitions");
    let mut labels = Vec::with_capacity(dataset.step_count());
    for episode in dataset.episodes() {
        if interrupt::requested() {
            return Err(LearnError::Interrupted);
        }
        labels.extend(transformer.beginning(dataset, episode));
        if episode.len > transformer.segment {
            let quick = transformer.sliding(dataset, episode);
            labels.extend(quick.unwrap_or_else(|| transformer.windows(dataset, episode)));
        }
        progress.advance(episode.len as u64);
    }
    progress.finish();
    Ok(labels)
}

impl RewardTransformer {
    /// Rewards of the steps up to the first whole window: what windows begin with is one clip.
    fn beginning(&self, dataset: &Dataset, episode: &Episode) -> Vec<f32> {
        let steps = episode.first_step..episode.first_step + episode.len.min(self.segment);
        numbers(&self.network.rewards(&self.clips(dataset, steps, 1)))
    }

    /// Rewards of the steps after it, where there is a quick way.
    fn sliding(&self, dataset: &Dataset, episode: &Episode) -> Option<Vec<f32>> {
        let steps = episode.first_step + 1..episode.first_step + episode.len;
        let rewards = self.network.sliding_rewards(&self.clips(dataset, steps, 1));
        rewards.map(|rewards| numbers(&rewards))
    }

    /// The same, window by window.
    pub(super) fn windows(&self, dataset: &Dataset, episode: &Episode) -> Vec<f32> {
        let starts = episode.first_step + 1..=episode.first_step + episode.len - self.segment;
        let starts: Vec<usize> = starts.collect();
        let rewards = starts.chunks(WINDOWS).flat_map(|starts| {
            let steps = starts.iter().flat_map(|&first| first..first + self.segment);
            let clips = self.clips(dataset, steps, starts.len());
            numbers(&self.network.last_rewards(&clips))
        });
        rewards.collect()
    }
}
