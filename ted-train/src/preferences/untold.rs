//! The pairs of segments that nobody could tell apart, which are not asked about again, and those that were put off, which are not
//! asked about again before another answer is in.

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

    /// Whether a pair is not to be asked about now, whichever of the two is shown first.
    #[must_use]
    pub fn contains(self, pair: [Segment; 2]) -> bool {
        let answered = self.0.iter().rposition(|it| it.said.answer.is_some());
        let mut closed = (self.0.iter().enumerate())
            .filter(|(place, it)| !it.said.later || answered.is_none_or(|last| *place > last))
            .filter(|(_, it)| it.said.answer.is_none());
        closed.any(|(_, it)| it.question.query.is_about(pair))
    }

    /// Whether somebody has an answer about a pair already, which is no reason against asking again: it is the strategy's to say.
    #[must_use]
    pub fn is_told(self, pair: [Segment; 2]) -> bool {
        let mut told = self.0.iter().filter(|it| it.said.answer.is_some());
        told.any(|it| it.question.query.is_about(pair))
    }

    /// How many questions got no answer.
    #[must_use]
    pub fn count(self) -> usize {
        let untold = self.0.iter().filter(|it| it.said.answer.is_none());
        untold.count()
    }
}
