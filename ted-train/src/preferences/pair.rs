//! A question with its answer, as whoever learns from it sees both.

use super::{Answer, Query};
use crate::dataset::Segment;

/// A pair of segments with its label, the probability that the second one is preferred.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabelledPair {
    /// The two segments, in the order they were shown.
    pub segments: [Segment; 2],
    /// 0, 1 or 0.5.
    pub label: f32,
}

impl LabelledPair {
    /// What was asked, and what was said.
    #[must_use]
    pub fn new(query: Query, answer: Answer) -> Self {
        Self {
            segments: query.segments,
            label: answer.label(),
        }
    }
}
