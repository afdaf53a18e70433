//! Made-up batches that tests of every learner share.

use crate::nn::fixtures::numbers;

use super::Batch;

/// Sizes of a made-up batch.
pub(crate) const OBSERVATION: usize = 3;
pub(crate) const ACTION: usize = 2;
pub(crate) const ROWS: usize = 6;

/// A batch for each lane, the same wherever the lane stands.
pub(crate) fn batch(lanes: &[u64], step: u64) -> Batch {
    let mut batch = Batch::default();
    for lane in lanes {
        let draw = |name: &str, count| numbers(count, &format!("{lane}/{step}/{name}"));
        batch.observations.extend(draw("s", ROWS * OBSERVATION));
        let next = draw("s'", ROWS * OBSERVATION);
        batch.next_observations.extend(next);
        batch.actions.extend(draw("a", ROWS * ACTION));
        batch.rewards.extend(draw("r", ROWS));
        // Discounts of both kinds, and terminals.
        batch
            .discounts
            .extend([0.99, 0.693, 0.99, 0.0, 0.693, 0.99]);
    }
    batch
}
