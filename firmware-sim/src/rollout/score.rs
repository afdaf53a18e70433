//! The numbers a flight is judged by.

use super::EpisodeReport;

/// The return as a share of the best return in the dataset the policy was trained on; none when that is not positive,
/// as a share of it would say nothing.
#[must_use]
pub fn normalised_score(return_true: f64, dataset_max_return: f64) -> Option<f64> {
    (dataset_max_return > 0.0 && dataset_max_return.is_finite())
        .then(|| return_true / dataset_max_return)
}

/// Episodes in a few numbers. The sums run in episode order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// How many episodes.
    pub episodes: usize,
    /// The mean return.
    pub return_mean: f64,
    /// The sample standard deviation of the returns (n - 1); zero for one episode.
    pub return_sd: f64,
    /// The share of episodes that were solved at some step.
    pub success_rate: f64,
    /// How many episodes latched a fault.
    pub faulted: usize,
}

impl Summary {
    /// Sums up; no episodes give zeros.
    #[must_use]
    pub fn of(episodes: &[EpisodeReport]) -> Self {
        let count = episodes.len().max(1) as f64;
        let return_mean = episodes
            .iter()
            .map(|episode| episode.return_true)
            .sum::<f64>()
            / count;
        let squares = episodes
            .iter()
            .map(|episode| (episode.return_true - return_mean).powi(2));
        let variance = squares.sum::<f64>() / (count - 1.0).max(1.0);
        Self {
            episodes: episodes.len(),
            return_mean,
            return_sd: variance.sqrt(),
            success_rate: episodes.iter().filter(|episode| episode.success).count() as f64 / count,
            faulted: episodes
                .iter()
                .filter(|episode| episode.fault.is_some())
                .count(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn episode(return_true: f64, success: bool) -> EpisodeReport {
        EpisodeReport {
            seed: 0,
            return_true,
            success,
            ticks: 1,
            fault: None,
            clamped_ticks: 0,
            slew_limited_ticks: 0,
            deadlines_missed: 0,
        }
    }

    #[test]
    fn mean_deviation_and_success_are_those_of_the_sample() {
        let summary = Summary::of(&[
            episode(1.0, true),
            episode(2.0, false),
            episode(3.0, false),
            episode(6.0, true),
        ]);
        assert_eq!((summary.return_mean, summary.success_rate), (3.0, 0.5));
        assert_eq!(summary.return_sd, (14.0_f64 / 3.0).sqrt());
    }

    #[test]
    fn one_episode_or_none_has_no_deviation() {
        assert_eq!(Summary::of(&[episode(5.0, true)]).return_sd, 0.0);
        assert_eq!(Summary::of(&[]).return_mean, 0.0);
    }

    #[test]
    fn a_share_of_a_return_that_is_not_positive_is_not_a_score() {
        assert_eq!(normalised_score(50.0, 100.0), Some(0.5));
        assert_eq!(normalised_score(50.0, 0.0), None);
        assert_eq!(normalised_score(50.0, -1.0), None);
    }
}
