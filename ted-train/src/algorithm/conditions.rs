//! How good the episode of each transition is predicted to be, and how far a policy that is told may go by it.

use crate::dataset::Dataset;
use crate::filter::Kept;
use crate::ranking::ranking;

/// The condition of each transition: 0 is the average of the kept episodes, 1 the mean of the best of them. The default is of
/// nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Conditions {
    of_steps: Vec<f32>,
    advance: f32,
}

/// Returns are sums in single precision: a difference below this share of the largest is rounding.
const ROUNDING: f64 = f32::EPSILON as f64;

impl Default for Conditions {
    fn default() -> Self {
        Self {
            of_steps: Vec::new(),
            advance: 1.0,
        }
    }
}

impl Conditions {
    /// `(R - mean R) / (mean of the best R - mean R)` of the episode of each step, where `quality` has R of every episode: the
    /// quality that a model gives it, or its predicted return. Both means are over the episodes that are kept, the second over the
    /// `best` of them with the highest R, or all of them if they are fewer. Where the two means are equal, every condition is 0.
    #[must_use]
    pub fn new(dataset: &Dataset, kept: &Kept, quality: &[f32], best: usize) -> Self {
        let all = dataset.episodes().iter().zip(quality);
        let returns: Vec<f64> = all
            .filter(|(episode, _)| kept.holds(episode.first_step))
            .map(|(_, &of_episode)| of_episode.into())
            .collect();
        let mut best_returns: Vec<f64> = ranking(&returns).iter().map(|&i| returns[i]).collect();
        best_returns.truncate(best.max(1));
        let average = mean(&returns);
        let spread = mean(&best_returns) - average;
        let largest = returns.iter().fold(0.0, |most: f64, r| most.max(r.abs()));
        // Not a number is no spread either.
        let differ = spread > ROUNDING * largest;
        let condition = |of_episode: f32| match differ {
            true => ((f64::from(of_episode) - average) / spread) as f32,
            false => 0.0,
        };
        let episodes = dataset.episodes().iter().zip(quality);
        let of_steps = episodes
            .flat_map(|(episode, &hat)| std::iter::repeat_n(condition(hat), episode.len))
            .collect();
        Self {
            of_steps,
            ..Self::default()
        }
    }

    /// Lets the policy fly at this share of its aim; all of it if nobody says another. What is below 0 or not a number is 0,
    /// what is above 1 is 1.
    #[must_use]
    pub fn advanced(self, share: f32) -> Self {
        // Not a number is not above anything.
        let advance = if share > 0.0 { share.min(1.0) } else { 0.0 };
        Self { advance, ..self }
    }

    /// The condition of a step of the dataset; none where there are none.
    #[must_use]
    pub fn of(&self, step: usize) -> Option<f32> {
        self.of_steps.get(step).copied()
    }

    /// The share of its aim that the policy flies at, in [0, 1]: 0 where the conditions are equal, since they teach no way from
    /// the average.
    #[must_use]
    pub fn advance(&self) -> f32 {
        match self.are_equal() {
            true => 0.0,
            false => self.advance,
        }
    }

    /// Whether every condition is 0: then there is nothing to go by, and plain cloning is all that is left.
    #[must_use]
    pub fn are_equal(&self) -> bool {
        self.of_steps.iter().all(|&condition| condition == 0.0)
    }
}

/// Of no numbers, which is the kept episodes of no dataset, not a number.
fn mean(of: &[f64]) -> f64 {
    of.iter().sum::<f64>() / of.len() as f64
}
