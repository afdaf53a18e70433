//! How long ticks took: all of them are kept, so percentiles are exact.

use std::time::Duration;

/// Tick durations, to the nanosecond.
#[derive(Clone, Debug, Default)]
pub struct TickTimes {
    nanos: Vec<u32>,
}

impl TickTimes {
    /// Adds one tick. Anything over four seconds counts as four seconds.
    pub fn push(&mut self, duration: Duration) {
        self.nanos
            .push(u32::try_from(duration.as_nanos()).unwrap_or(u32::MAX));
    }

    /// Adds the ticks of another flight.
    pub fn append(&mut self, mut other: Self) {
        self.nanos.append(&mut other.nanos);
    }

    /// The shortest durations that this share of the ticks, from 0 to 1, did not exceed; in microseconds, one per
    /// share. Zero when there were no ticks.
    #[must_use]
    pub fn percentiles_us(&self, shares: &[f64]) -> Vec<f64> {
        let mut sorted = self.nanos.clone();
        sorted.sort_unstable();
        let at = |share: f64| {
            let rank = (share * sorted.len() as f64).ceil() as usize;
            let nanos = sorted.get(rank.clamp(1, sorted.len().max(1)) - 1);
            f64::from(nanos.copied().unwrap_or(0)) / 1e3
        };
        shares.iter().copied().map(at).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_durations_that_occurred() {
        let mut times = TickTimes::default();
        for micros in (1..=100).rev() {
            times.push(Duration::from_micros(micros));
        }
        assert_eq!(
            times.percentiles_us(&[0.0, 0.5, 0.99, 1.0]),
            [1.0, 50.0, 99.0, 100.0]
        );
    }

    #[test]
    fn no_ticks_took_no_time() {
        assert_eq!(TickTimes::default().percentiles_us(&[0.5]), [0.0]);
    }
}
