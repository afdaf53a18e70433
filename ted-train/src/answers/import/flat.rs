//! Steps counted over all episodes as `d4rl.qlearning_dataset` counts them, which the published labels do.
//!
//! That function leaves out the last step of an episode whose recording only ended (a timeout), since it has no next observation, and
//! the last step of the dataset.

use crate::dataset::Dataset;
use crate::preferences::Span;

/// Where each episode begins in that count.
pub(super) struct FlatSteps {
    /// The first step of every episode, and the number of all steps.
    starts: Vec<u64>,
}

impl FlatSteps {
    pub fn of(dataset: &Dataset) -> Self {
        let mut starts = vec![0];
        let episodes = dataset.episodes();
        let mut all = 0;
        for (index, episode) in episodes.iter().enumerate() {
            let last = episode.first_step + episode.len - 1;
            let left_out = dataset.truncations()[last] || index + 1 == episodes.len();
            all += episode.len as u64 - u64::from(left_out);
            starts.push(all);
        }
        Self { starts }
    }

    /// So many steps from this one on, if they lie in one episode.
    ///
    /// # Errors
    /// With the reason, when they do not.
    pub fn span(&self, start: u64, length: u32) -> Result<Span, String> {
        let steps = self.starts.last().copied().unwrap_or_default();
        let after = self.starts.partition_point(|&first| first <= start);
        let (Some(&first), Some(&next)) = (self.starts.get(after - 1), self.starts.get(after))
        else {
            return Err(format!(
                "step {start} is none of the dataset, which has {steps} as d4rl.qlearning_dataset counts them"
            ));
        };
        let episode = after - 1;
        if start + u64::from(length) > next {
            return Err(format!(
                "{length} steps from step {start} on run past the end of episode {episode}, whose steps are {first} to {} as \
                 d4rl.qlearning_dataset counts them: is this the dataset that was labelled?",
                next - 1
            ));
        }
        // Neither is more than the steps of a dataset, which are less than 2^32.
        Ok(Span {
            episode: episode as u32,
            start: (start - first) as u32,
            length,
        })
    }
}
