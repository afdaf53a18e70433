//! The pairs of segments that nobody could tell apart, which are not asked about again.

use super::LogEntry;
use crate::dataset::Segment;

/// Pairs that somebody was asked about and could not tell apart.
#[derive(Clone, Copy, Debug)]
pub struct Untold<'a>(&'a [LogEntry]);

impl<'a> Untold<'a> {
    /// Those of these questions that have no answer.
    #[must_use]
    pub fn of(asked: &'a [LogEntry]) -> Self {
        Self(asked)
    }

    /// Whether a pair is one of them, whichever of the two is shown first.
    #[must_use]
    pub fn contains(self, [first, second]: [Segment; 2]) -> bool {
        let mut pairs = self.pairs();
        pairs.any(|pair| pair == [first, second] || pair == [second, first])
    }

    /// How many there are.
    #[must_use]
    pub fn count(self) -> usize {
        self.pairs().count()
    }

    fn pairs(self) -> impl Iterator<Item = [Segment; 2]> + use<'a> {
        let entries = self.0.iter().filter(|entry| entry.said.answer.is_none());
        entries.map(|entry| entry.question.query.segments)
    }
}
