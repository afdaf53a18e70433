//! How sure it is that the best episodes are better than the logs.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// What the posterior says of the episodes that a policy would imitate, beside the average episode.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Confidence {
    /// Answers that it rests on.
    pub answers: usize,
    /// Answers, ties left out, that go with the mean weights.
    pub agreeing: usize,
    /// How far the best are above the average, in standard deviations of the episodes' quality.
    pub gain: f64,
    /// The 5th and the 95th percentile of that.
    pub range: [f64; 2],
    /// Probability that they are better than the average at all.
    pub better: f64,
    /// Whether that is sure enough for a policy to leave the logs.
    pub leaves_the_logs: bool,
}

impl Confidence {
    /// From the answers and how many agree, samples of the weights, the descriptors of every episode, and which ones are the best
    /// by the mean weights.
    pub(super) fn new(
        [answers, agreeing]: [usize; 2],
        samples: &DMatrix<f64>,
        descriptors: &DMatrix<f64>,
        best: &[usize],
        sure: f64,
    ) -> Self {
        let mean = descriptors.row_mean();
        let mut ahead = DVector::zeros(descriptors.ncols());
        for &episode in best {
            ahead += (descriptors.row(episode) - &mean).transpose() / best.len() as f64;
        }
        let weights = samples.row_mean().transpose();
        let quality = descriptors * &weights;
        let spread = quality.variance().sqrt().max(1e-12);
        let mut gains: Vec<f64> = (samples * ahead).iter().map(|gain| gain / spread).collect();
        gains.sort_by(f64::total_cmp);
        let count = gains.len();
        let percentile = |p: usize| gains[(count * p / 100).min(count - 1)];
        let better = gains.iter().filter(|&&gain| gain > 0.0).count() as f64 / count as f64;
        Self {
            answers,
            agreeing,
            gain: gains.iter().sum::<f64>() / count as f64,
            range: [percentile(5), percentile(95)],
            better,
            leaves_the_logs: better >= sure,
        }
    }

    /// The same in words.
    #[must_use]
    pub fn in_words(&self) -> String {
        let Self {
            answers,
            agreeing,
            gain,
            range: [low, high],
            better,
            leaves_the_logs,
        } = self;
        let by = match answers {
            0 => "without an answer".to_owned(),
            _ => format!("by {answers} answers, {agreeing} of which agree with the rest"),
        };
        // Else a small negative number is said as -0.0.
        let [gain, low, high] = [gain, low, high].map(|it| (10.0 * it).round() / 10.0 + 0.0);
        let sure = format!(
            "{by}, the episodes that look best are {gain:.1} deviations \
             above the average of the logs (90 % interval {low:.1} to {high:.1}), and better at all with a probability of {:.0} %",
            100.0 * better
        );
        if *leaves_the_logs {
            format!("{sure}: the policy imitates them")
        } else {
            let advice = self.advice();
            format!(
                "{sure}: that is not sure enough, so the policy imitates the average of the logs; {advice}"
            )
        }
    }

    /// What would make it surer.
    fn advice(&self) -> &'static str {
        /// Answers after which it can be said whether they go together.
        const FEW: usize = 5;
        if self.range == [0.0; 2] {
            "nothing that was looked at tells the episodes apart, so answers cannot help"
        } else if self.answers == 0 {
            "answer five questions"
        } else if self.answers < FEW || 2 * self.agreeing > self.answers {
            "answer five more questions"
        } else {
            "most answers are ties or do not go together, so look at them again before you answer more"
        }
    }
}
