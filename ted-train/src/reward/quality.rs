//! How well learned rewards order what is in the dataset.

use serde::{Deserialize, Serialize};

use crate::dataset::Dataset;
use crate::ranking::{ranking, ranks};

use super::Labels;

/// Agreement of learned rewards with the true ones, over the whole dataset.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RewardQuality {
    /// Pearson correlation of predicted and true episode returns.
    pub pearson: f64,
    /// Spearman rank correlation of predicted and true episode returns.
    pub spearman: f64,
    /// Pearson over the third of episodes with the lowest predicted return.
    pub pearson_low_third: f64,
    /// Pearson over the third of episodes with the highest predicted return.
    pub pearson_high_third: f64,
    /// Spearman over the third of episodes with the lowest predicted return: what TED relies on.
    pub spearman_low_third: f64,
    /// Spearman over the third of episodes with the highest predicted return.
    pub spearman_high_third: f64,
    /// Mean absolute error of the min-max scaled returns over the lowest predicted third (the paper's Figure 1).
    pub error_low_third: f64,
    /// The same over the highest predicted third.
    pub error_high_third: f64,
    /// Pearson correlation of predicted and true rewards of single transitions.
    pub transition_pearson: f64,
    /// Share of the 5 % of episodes with the highest true return that lie in the predicted top 70 %.
    pub best_kept: f64,
    /// Mean true return of the predicted top 10 % of episodes over the mean true return of all, if that is not 0.
    pub top_decile_lift: Option<f64>,
}

impl RewardQuality {
    /// Measures labels against the dataset's own rewards; none where these are all the same, and nothing goes with them.
    #[must_use]
    pub fn measure(dataset: &Dataset, labels: &Labels) -> Option<Self> {
        if dataset.only_reward().is_some() {
            return None;
        }
        let hat: Vec<f64> = labels.returns_hat.iter().copied().map(f64::from).collect();
        let truth: Vec<f64> = dataset.episodes().iter().map(|e| e.return_true).collect();
        let ranking = ranking(&hat);
        let third = hat.len() / 3;
        let (high, low) = (&ranking[..third], &ranking[hat.len() - third..]);
        let (hat_unit, truth_unit) = (unit(&hat), unit(&truth));
        let pearson_of = |set: &[usize]| pearson(&pick(&hat, set), &pick(&truth, set));
        let spearman_of = |set: &[usize]| spearman(&pick(&hat, set), &pick(&truth, set));
        let error_of = |set: &[usize]| {
            set.iter()
                .map(|&i| (hat_unit[i] - truth_unit[i]).abs())
                .sum::<f64>()
                / third.max(1) as f64
        };
        let rewards_hat: Vec<f64> = labels.rewards.iter().map(|&r| f64::from(r)).collect();
        let rewards_true: Vec<f64> = dataset
            .rewards_true()
            .iter()
            .map(|&r| f64::from(r))
            .collect();
        let decile = &ranking[..hat.len().div_ceil(10)];
        let mean_true = mean(&truth);
        Some(Self {
            pearson: pearson(&hat, &truth),
            spearman: spearman(&hat, &truth),
            pearson_low_third: pearson_of(low),
            pearson_high_third: pearson_of(high),
            spearman_low_third: spearman_of(low),
            spearman_high_third: spearman_of(high),
            error_low_third: error_of(low),
            error_high_third: error_of(high),
            transition_pearson: pearson(&rewards_hat, &rewards_true),
            best_kept: best_kept(&hat, &truth, 0.05, 0.7),
            top_decile_lift: (mean_true != 0.0).then(|| mean(&pick(&truth, decile)) / mean_true),
        })
    }
}

/// Share of the best `best` of episodes by true return that are in the top `top` by predicted return.
#[must_use]
pub fn best_kept(hat: &[f64], truth: &[f64], best: f64, top: f64) -> f64 {
    let count = |share: f64| ((hat.len() as f64 * share).round() as usize).max(1);
    let (kept, wanted) = (ranking(hat), ranking(truth));
    let (kept, wanted) = (&kept[..count(top)], &wanted[..count(best)]);
    wanted.iter().filter(|i| kept.contains(i)).count() as f64 / wanted.len() as f64
}

/// Pearson correlation; 0 when one side is constant.
#[must_use]
pub fn pearson(a: &[f64], b: &[f64]) -> f64 {
    let (mean_a, mean_b) = (mean(a), mean(b));
    let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
    for (x, y) in a.iter().zip(b) {
        let (x, y) = (x - mean_a, y - mean_b);
        ab += x * y;
        aa += x * x;
        bb += y * y;
    }
    if aa == 0.0 || bb == 0.0 {
        0.0
    } else {
        ab / (aa * bb).sqrt()
    }
}

/// Spearman rank correlation, ties sharing their mean rank.
#[must_use]
pub fn spearman(a: &[f64], b: &[f64]) -> f64 {
    pearson(&ranks(a), &ranks(b))
}

fn pick(values: &[f64], set: &[usize]) -> Vec<f64> {
    set.iter().map(|&i| values[i]).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

fn unit(values: &[f64]) -> Vec<f64> {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let span = if high > low { high - low } else { 1.0 };
    values.iter().map(|v| (v - low) / span).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::fixtures::{SHAPE, records};

    /// Episodes of one step, whose returns are these.
    fn measured(hat: &[f32], truth: &[f64]) -> RewardQuality {
        let mut records = records(&vec![1; truth.len()]);
        for (record, &reward) in records.iter_mut().zip(truth) {
            record.rewards = vec![reward];
        }
        let dataset = Dataset::from_records("ted/x-v0", SHAPE, &records).unwrap();
        RewardQuality::measure(&dataset, &Labels::raw(&dataset, hat.to_vec())).unwrap()
    }

    #[test]
    fn a_measurement_is_what_a_hand_computes() {
        let hat: Vec<f32> = (0..9).map(|i| i as f32).collect();
        // The lowest third is predicted the wrong way round, the highest with its last two exchanged.
        let truth = [4.0, 2.0, 0.0, 3.0, 5.0, 7.0, 6.0, 10.0, 8.0];
        let quality = measured(&hat, &truth);
        // Sums of products of deviations, from the means 4 and 5.
        let pearson = 56.0 / (60.0f64 * 78.0).sqrt();
        for (what, actual, expected) in [
            ("pearson", quality.pearson, pearson),
            ("spearman", quality.spearman, 51.0 / 60.0),
            ("pearson, low", quality.pearson_low_third, -1.0),
            ("pearson, high", quality.pearson_high_third, 0.5),
            ("spearman, low", quality.spearman_low_third, -1.0),
            ("spearman, high", quality.spearman_high_third, 0.5),
            ("error, low", quality.error_low_third, 0.725 / 3.0),
            ("error, high", quality.error_high_third, 0.475 / 3.0),
            ("transitions", quality.transition_pearson, pearson),
            ("best kept", quality.best_kept, 1.0),
            ("lift", quality.top_decile_lift.unwrap(), 8.0 / 5.0),
        ] {
            assert!((actual - expected).abs() < 1e-12, "{what}: {actual}");
        }
    }

    #[test]
    fn nothing_is_measured_against_rewards_that_are_all_the_same() {
        let mut records = records(&[1, 1, 1]);
        records.iter_mut().for_each(|it| it.rewards = vec![0.5]);
        let dataset = Dataset::from_records("ted/x-v0", SHAPE, &records).unwrap();
        let labels = Labels::raw(&dataset, vec![1.0, 2.0, 3.0]);
        assert_eq!(RewardQuality::measure(&dataset, &labels), None);
    }

    #[test]
    fn a_measurement_against_returns_whose_mean_is_zero_can_be_written_and_read() {
        let quality = measured(&[1.0, 2.0, 3.0], &[-1.0, 0.0, 1.0]);
        assert_eq!(quality.top_decile_lift, None);
        let text = serde_json::to_string(&quality).unwrap();
        assert_eq!(
            serde_json::from_str::<RewardQuality>(&text).unwrap(),
            quality
        );
    }

    #[test]
    fn the_earlier_of_equal_episodes_is_in_the_top_as_it_is_for_ted() {
        let equal = [1.0; 4];
        assert_eq!(best_kept(&equal, &[9.0, 0.0, 0.0, 0.0], 0.25, 0.5), 1.0);
        assert_eq!(best_kept(&equal, &[0.0, 0.0, 0.0, 9.0], 0.25, 0.5), 0.0);
    }

    #[test]
    fn spearman_gives_tied_values_their_mean_rank() {
        // Ranks 0, 1.5, 1.5, 3 against 0, 1, 2, 3: cov 4.5, variances 4.5 and 5.
        let rho = spearman(&[1.0, 2.0, 2.0, 9.0], &[1.0, 2.0, 3.0, 4.0]);
        assert!((rho - 4.5 / (4.5f64 * 5.0).sqrt()).abs() < 1e-12, "{rho}");
    }

    #[test]
    fn correlations_of_a_constant_are_zero() {
        assert_eq!(pearson(&[1.0, 1.0, 1.0], &[1.0, 2.0, 3.0]), 0.0);
    }

    #[test]
    fn best_kept_counts_the_best_true_episodes_in_the_predicted_top() {
        let truth: Vec<f64> = (0..20).map(f64::from).collect();
        assert_eq!(best_kept(&truth, &truth, 0.1, 0.7), 1.0);
        let reversed: Vec<f64> = truth.iter().map(|t| -t).collect();
        assert_eq!(best_kept(&reversed, &truth, 0.1, 0.7), 0.0);
    }
}
