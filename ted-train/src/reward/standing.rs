//! What answers did so far, for whoever wants to know before a reward is learned from them.

use crate::dataset::Segment;

use super::episodes::Confidence;

/// What is believed after so many answers.
#[derive(Clone, Debug, PartialEq)]
pub struct Standing {
    /// Every episode, the best first.
    pub ranking: Vec<Ranked>,
    /// How sure it is that the best are better than the logs.
    pub confidence: Confidence,
    /// Rank correlation of this order with the one that was believed before any answer; none where there was no order.
    pub like_before: Option<f64>,
    /// The answers, by their place in the log, that are held to be slips: the others together say the opposite.
    pub slips: Vec<usize>,
}

/// An episode and how good it is held to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ranked {
    /// All of it.
    pub segment: Segment,
    /// How far its quality is above the mean of the logs, in standard deviations over episodes.
    pub above: f64,
}
