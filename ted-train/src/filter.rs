//! Which episodes the offline algorithm may draw from: all of them, or those with the highest returns.
//!
//! `top-predicted` is the paper's PT+DatasetTruncating: what TED gives a lower discount is thrown away instead. `top-true` with
//! `k = 10` is the data of its baseline "Top 10 % BC". The top k % are those of [`crate::ted`]: rounded to whole episodes, and
//! between equal returns the earlier episode wins. Only draws change: labels, discounts and the statistics that observations
//! are standardised with are those of the whole dataset.

use serde::{Deserialize, Serialize};

use crate::dataset::Dataset;
use crate::ranking::{ranking, share};

/// The choice of episodes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "keep", rename_all = "kebab-case", deny_unknown_fields)]
pub enum FilterConfig {
    /// All of them.
    All {},
    /// Those with the highest predicted returns.
    TopPredicted {
        /// Share of the episodes, in percent; above 0.
        k: f64,
    },
    /// Those with the highest true returns.
    TopTrue {
        /// Share of the episodes, in percent; above 0.
        k: f64,
    },
}

/// A share of the episodes that is none of them.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the filter keeps {k} % of {episodes} episodes, which is none: raise filter.k")]
pub struct NothingKept {
    /// The share, in percent.
    pub k: f64,
    /// Episodes of the dataset.
    pub episodes: usize,
}

impl FilterConfig {
    /// Whether anything is kept of so many episodes.
    ///
    /// # Errors
    /// When the share is less than half an episode.
    pub fn check(&self, episodes: usize) -> Result<(), NothingKept> {
        match *self {
            Self::TopPredicted { k } | Self::TopTrue { k } if share(episodes, k) == 0 => {
                Err(NothingKept { k, episodes })
            }
            _ => Ok(()),
        }
    }

    /// Whether it looks at the dataset's own rewards.
    #[must_use]
    pub fn looks_at_rewards(&self) -> bool {
        matches!(self, Self::TopTrue { .. })
    }

    /// The transitions of the episodes that are kept. `returns_hat` are the predicted returns of all episodes.
    ///
    /// # Errors
    /// When [`Self::check`] does.
    pub fn kept(&self, dataset: &Dataset, returns_hat: &[f32]) -> Result<Kept, NothingKept> {
        self.check(dataset.episodes().len())?;
        let (k, returns): (f64, Vec<f64>) = match *self {
            Self::All {} => return Ok(Kept::all(dataset)),
            Self::TopPredicted { k } => (k, returns_hat.iter().copied().map(f64::from).collect()),
            Self::TopTrue { k } => {
                let episodes = dataset.episodes().iter();
                (k, episodes.map(|e| e.return_true).collect())
            }
        };
        let mut episodes = ranking(&returns);
        episodes.truncate(share(episodes.len(), k));
        episodes.sort_unstable();
        Ok(Kept::of(dataset, &episodes))
    }
}

/// The transitions that may be drawn: at least one, in recorded order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Kept(Steps);

#[derive(Clone, Debug, PartialEq, Eq)]
enum Steps {
    /// The first so many, which is all of them: a draw needs no table.
    All(usize),
    These(Vec<u32>),
}

impl Kept {
    /// All transitions of a dataset.
    #[must_use]
    pub fn all(dataset: &Dataset) -> Self {
        Self(Steps::All(dataset.step_count()))
    }

    /// The transitions of these episodes.
    fn of(dataset: &Dataset, episodes: &[usize]) -> Self {
        if episodes.len() == dataset.episodes().len() {
            return Self::all(dataset);
        }
        let steps = episodes.iter().flat_map(|&index| {
            let episode = dataset.episodes()[index];
            episode.first_step..episode.first_step + episode.len
        });
        // No dataset has more than 2^32 observations: `dataset::assemble` refuses it.
        Self(Steps::These(steps.map(|step| step as u32).collect()))
    }

    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        match &self.0 {
            Steps::All(count) => *count,
            Steps::These(steps) => steps.len(),
        }
    }

    /// Whether this step of the dataset is one of them.
    #[must_use]
    pub fn holds(&self, step: usize) -> bool {
        match &self.0 {
            Steps::All(count) => step < *count,
            Steps::These(steps) => steps.binary_search_by_key(&step, |&s| s as usize).is_ok(),
        }
    }

    /// The step in the dataset of the `index`-th of them; `index` is below [`Self::count`].
    #[must_use]
    pub fn step(&self, index: usize) -> usize {
        match &self.0 {
            Steps::All(_) => index,
            Steps::These(steps) => steps[index] as usize,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algorithm::Replay;
    use crate::dataset::fixtures::{SHAPE, records};
    use crate::rng::Seed;

    const LENGTHS: [usize; 4] = [2, 3, 1, 4];

    /// Four episodes with these true returns.
    fn dataset(returns: [f64; 4]) -> Dataset {
        let mut records = records(&LENGTHS);
        for (record, total) in records.iter_mut().zip(returns) {
            let steps = record.rewards.len() as f64;
            record.rewards.fill(total / steps);
        }
        Dataset::from_records("ted/x-v0", SHAPE, &records).unwrap()
    }

    fn steps(kept: &Kept) -> Vec<usize> {
        (0..kept.count()).map(|index| kept.step(index)).collect()
    }

    #[test]
    fn the_steps_of_the_episodes_with_the_highest_returns_are_kept_in_recorded_order() {
        let dataset = dataset([4.0, 1.0, 3.0, 2.0]);
        let returns_hat = [0.0, 5.0, 2.0, 9.0];
        let kept = |filter: FilterConfig| steps(&filter.kept(&dataset, &returns_hat).unwrap());
        assert_eq!(kept(FilterConfig::TopTrue { k: 50.0 }), [0, 1, 5]);
        let predicted = kept(FilterConfig::TopPredicted { k: 50.0 });
        assert_eq!(predicted, [2, 3, 4, 6, 7, 8, 9]);
        assert_eq!(kept(FilterConfig::TopTrue { k: 25.0 }), [0, 1]);
    }

    #[test]
    fn ties_and_shares_are_those_of_ted() {
        let dataset = dataset([1.0; 4]);
        let returns_hat = [1.0, 2.0, 1.0, 1.0];
        let kept = |k| FilterConfig::TopPredicted { k }.kept(&dataset, &returns_hat);
        // Half of four is two: the second, and of the three equal ones the first.
        assert_eq!(steps(&kept(50.0).unwrap()), [0, 1, 2, 3, 4]);
        // 12.5 % of four is half an episode, which is rounded up.
        assert_eq!(steps(&kept(12.5).unwrap()), [2, 3, 4]);
        let (k, episodes) = (12.4, 4);
        assert_eq!(kept(k), Err(NothingKept { k, episodes }));
    }

    #[test]
    fn a_filter_that_keeps_everything_is_no_filter() {
        let dataset = dataset([4.0, 1.0, 3.0, 2.0]);
        let returns_hat = [0.0; 4];
        for filter in [
            FilterConfig::All {},
            FilterConfig::TopTrue { k: 100.0 },
            FilterConfig::TopPredicted { k: 90.0 },
        ] {
            let kept = filter.kept(&dataset, &returns_hat).unwrap();
            assert_eq!(kept, Kept::all(&dataset), "{filter:?}");
        }
        assert_eq!(Kept::all(&dataset).count(), 10);
    }

    /// Labels that name their step, so that a batch says what was drawn.
    fn replay(dataset: &Dataset) -> Replay<'_> {
        let names = (0..dataset.step_count()).map(|step| step as f32).collect();
        Replay::new(dataset, names, vec![0.9; dataset.step_count()])
    }

    #[test]
    fn a_replay_draws_every_kept_step_and_no_other() {
        let dataset = dataset([4.0, 1.0, 3.0, 2.0]);
        let kept = FilterConfig::TopTrue { k: 75.0 }
            .kept(&dataset, &[])
            .unwrap();
        let replay = replay(&dataset).keep(kept);
        let mut drawn: Vec<usize> = replay
            .batch(Seed::root(3), 0, 200)
            .rewards
            .iter()
            .map(|&name| name as usize)
            .collect();
        drawn.sort_unstable();
        drawn.dedup();
        assert_eq!(drawn, [0, 1, 5, 6, 7, 8, 9]);
    }

    #[test]
    fn without_a_filter_a_replay_draws_what_it_always_drew() {
        let dataset = dataset([4.0, 1.0, 3.0, 2.0]);
        let kept = FilterConfig::All {}.kept(&dataset, &[]).unwrap();
        let drawn = replay(&dataset)
            .keep(kept)
            .batch(Seed::root(3), 0, 12)
            .rewards;
        let mut rng = Seed::root(3).rng_at(0);
        let straight: Vec<f32> = (0..12)
            .map(|_| rand::RngExt::random_range(&mut rng, 0..dataset.step_count()) as f32)
            .collect();
        assert_eq!(drawn, straight);
    }

    #[test]
    fn a_filter_is_written_and_read_as_toml() {
        for (filter, text) in [
            (FilterConfig::All {}, "keep = \"all\"\n"),
            (
                FilterConfig::TopPredicted { k: 70.0 },
                "keep = \"top-predicted\"\nk = 70.0\n",
            ),
            (
                FilterConfig::TopTrue { k: 10.0 },
                "keep = \"top-true\"\nk = 10.0\n",
            ),
        ] {
            assert_eq!(toml::to_string(&filter).unwrap(), text);
            assert_eq!(toml::from_str::<FilterConfig>(text).unwrap(), filter);
        }
        assert!(toml::from_str::<FilterConfig>("keep = \"all\"\nk = 10.0").is_err());
    }
}
