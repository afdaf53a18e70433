//! What a controller may expect and promise: the robot of a dataset, and the observations that a policy learned from.

use firmware_sim::robot::Sensor;
use ted_policy::{Contract, ContractFault};

use crate::dataset::Dataset;

/// An observation may leave the range of the logs by this share of its width ...
const RANGE_MARGIN: f32 = 0.5;

/// ... and at least by this many times what a channel resolves, so that a channel that never moved may tremble ...
const RESOLUTIONS: f32 = 20.0;

/// ... or, where nobody declared what it resolves, by this share of what it can read at all ...
const TREMBLE: f32 = 5e-3;

/// ... or, where nobody declared that either, by this share of its largest value.
const WHISPER: f32 = 1e-3;

/// The contract of a policy that was learned from this dataset: beyond the ranges of its observation the policy has never seen
/// anything.
///
/// # Errors
/// When there are more channels than the controller has room for, or a range is not finite.
pub fn contract(dataset: &Dataset) -> Result<Contract<'_>, ContractFault> {
    let task = dataset.task().unwrap_or("unknown");
    dataset.robot().contract(task, &accepted(dataset))
}

/// The range of each observation channel that a controller accepts, in its unit.
fn accepted(dataset: &Dataset) -> Vec<[f32; 2]> {
    let statistics = dataset.observation_statistics();
    let seen = statistics.min.iter().zip(&statistics.max);
    (dataset.robot().observation.iter().zip(seen))
        .map(|(sensor, (&low, &high))| widened(sensor, low, high))
        .collect()
}

/// What a channel may read that read from `low` to `high` in the logs. It is never more than the channel can read at all.
fn widened(sensor: &Sensor, low: f32, high: f32) -> [f32; 2] {
    let tremble = match (sensor.resolution, sensor.range) {
        (Some(resolution), _) => RESOLUTIONS * resolution,
        (None, Some([lowest, highest])) => TREMBLE * (highest - lowest),
        (None, None) => WHISPER * low.abs().max(high.abs()),
    };
    let margin = (RANGE_MARGIN * (high - low)).max(tremble);
    let [lowest, highest] = sensor.range.unwrap_or([f32::MIN, f32::MAX]);
    // What the logs hold was read, whatever is declared.
    let wide = [(low - margin).max(lowest), (high + margin).min(highest)];
    [wide[0].min(low), wide[1].max(high)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use firmware_sim::robot::Role;

    fn sensor(range: Option<[f32; 2]>, resolution: Option<f32>) -> Sensor {
        Sensor {
            name: "x".to_owned(),
            unit: "m".to_owned(),
            range,
            resolution,
            role: Role::None,
            guessed: Vec::new(),
        }
    }

    #[test]
    fn what_was_seen_may_be_left_by_half_its_width() {
        let [low, high] = widened(&sensor(None, None), 1.0, 3.0);
        assert_eq!([low, high], [0.0, 4.0]);
    }

    #[test]
    fn a_channel_that_never_moved_may_tremble_as_far_as_it_resolves() {
        let [low, high] = widened(&sensor(None, Some(0.001)), 0.0, 0.0);
        assert!((low + 0.02).abs() < 1e-8 && (high - 0.02).abs() < 1e-8);
        let [low, high] = widened(&sensor(Some([-2.0, 2.0]), None), 0.0, 0.0);
        assert!((low + 0.02).abs() < 1e-8 && (high - 0.02).abs() < 1e-8);
        let [low, high] = widened(&sensor(None, None), 5e-6, 5e-6);
        assert!(low > 4.9e-6 && high < 5.1e-6 && low < high, "{low} {high}");
    }

    #[test]
    fn nothing_is_accepted_that_a_channel_cannot_read_but_what_it_did_read() {
        let unit = Some([0.0, 1.0]);
        assert_eq!(widened(&sensor(unit, None), 0.25, 0.75), [0.0, 1.0]);
        assert_eq!(widened(&sensor(unit, None), 0.25, 1.5), [0.0, 1.5]);
    }
}
