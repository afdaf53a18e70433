//! Made-up batches that tests of every learner share.

use crate::nn::fixtures::numbers;

use super::Batch;

/// Sizes of a made-up batch.
pub(crate) const OBSERVATION: usize = 3;
pub(crate) const ACTION: usize = 2;
pub(crate) const ROWS: usize = 6;

/// A batch for each lane, the same wherever the lane stands.
pub(crate) fn batch(lanes: &[u64], step: u64) -> Batch {
    batch_of([ROWS, OBSERVATION, ACTION], lanes, step)
}

/// The same with so many rows, observations and actions.
pub(crate) fn batch_of([rows, observation, action]: [usize; 3], lanes: &[u64], step: u64) -> Batch {
    let of_lane = |lane: &u64| {
        let draw = |name: &str, count| numbers(count, &format!("{lane}/{step}/{name}"));
        // Discounts of both kinds, and terminals.
        let discounts = [0.99, 0.693, 0.99, 0.0, 0.693, 0.99].into_iter().cycle();
        Batch {
            observations: draw("s", rows * observation),
            next_observations: draw("s'", rows * observation),
            actions: draw("a", rows * action),
            rewards: draw("r", rows),
            discounts: discounts.take(rows).collect(),
            transitions: (0..rows as u32).collect(),
            conditions: draw("c", rows),
        }
    };
    Batch::of_lanes(lanes.iter().map(of_lane).collect())
}
