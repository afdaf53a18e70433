//! How a learning rate, and the share of the newest weights in an average, change over the updates.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

/// The rates at the start, at the end of the warm-up, and at the last step (optax's `warmup_cosine_decay_schedule`).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WarmupCosine {
    /// Of the first step.
    pub start: f64,
    /// After the warm-up.
    pub peak: f64,
    /// Towards the last step.
    pub end: f64,
    /// Share of all steps that the rate rises for.
    pub warmup: f64,
}

impl WarmupCosine {
    /// The rate of step `step` of `steps`, counted from 0.
    #[must_use]
    pub fn rate(&self, step: u64, steps: u64) -> f64 {
        let warmup = (self.warmup * steps as f64).floor();
        let step = step as f64;
        if step < warmup {
            return self.start + (self.peak - self.start) * step / warmup;
        }
        let done = ((step - warmup) / (steps as f64 - warmup).max(1.0)).min(1.0);
        self.end + (self.peak - self.end) * 0.5 * (1.0 + (PI * done).cos())
    }
}

/// The average forgets within a tenth of the updates made, as long as they are few.
const SHORT_AVERAGE: f64 = 10.0;

/// Share of the weights after update `step` (from 1) in their average: `last` once many updates are made, and more before, since
/// a long average would remember the first weights.
#[must_use]
pub fn average_share(last: f64, step: u64) -> f64 {
    last.max(SHORT_AVERAGE / (step as f64 + SHORT_AVERAGE))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_rises_linearly_and_falls_along_half_a_cosine() {
        let schedule = WarmupCosine {
            start: 1e-4,
            peak: 1e-3,
            end: 2e-4,
            warmup: 0.1,
        };
        // 100 steps: 10 of them up, then 90 down; half of the way down is the mean of peak and end.
        let expected = [
            (0, 1e-4),
            (5, 5.5e-4),
            (10, 1e-3),
            (55, 6e-4),
            (100, 2e-4),
            (200, 2e-4),
        ];
        for (step, rate) in expected {
            let actual = schedule.rate(step, 100);
            assert!((actual - rate).abs() < 1e-12, "step {step}: {actual}");
        }
    }

    #[test]
    fn without_a_warm_up_the_first_step_has_the_peak() {
        let schedule = WarmupCosine {
            start: 0.0,
            peak: 1.0,
            end: 0.0,
            warmup: 0.0,
        };
        assert_eq!(schedule.rate(0, 10), 1.0);
        assert_eq!(schedule.rate(0, 0), 1.0);
    }

    #[test]
    fn an_average_is_short_at_first_and_grows_long() {
        let shares = [1, 10, 9_990, 40_000].map(|step| average_share(1e-3, step));
        for (share, expected) in shares.into_iter().zip([10.0 / 11.0, 0.5, 1e-3, 1e-3]) {
            assert!((share - expected).abs() < 1e-12, "{share}");
        }
    }
}
