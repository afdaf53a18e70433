//! A question about two segments, and the three answers there are.

use super::Context;
use crate::dataset::Segment;

/// "Which of these two segments is better?"
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Query {
    /// The two segments, in the order in which they are shown.
    pub segments: [Segment; 2],
}

impl Query {
    /// Whether it is about these two segments, whichever of them is shown first.
    #[must_use]
    pub fn is_about(&self, [first, second]: [Segment; 2]) -> bool {
        self.segments == [first, second] || self.segments == [second, first]
    }
}

/// A query as a run asks it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Question {
    /// Which part of the procedure asks.
    pub context: Context,
    /// What it asks.
    pub query: Query,
    /// Why it asks this of all things, in words; none where there is no reason.
    pub why: Option<String>,
}

/// The answer to a query. Who cannot tell gives none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Answer {
    /// The first segment is better.
    First,
    /// The second segment is better.
    Second,
    /// Neither is better.
    Equal,
}

impl Answer {
    /// The label `y`: the probability, according to the answer, that the second segment is better.
    #[must_use]
    pub fn label(self) -> f32 {
        match self {
            Self::First => 0.0,
            Self::Second => 1.0,
            Self::Equal => 0.5,
        }
    }

    /// The answer with this label, if there is one.
    #[must_use]
    pub fn from_label(label: f64) -> Option<Self> {
        [Self::First, Self::Second, Self::Equal]
            .into_iter()
            .find(|answer| f64::from(answer.label()) == label)
    }

    /// The answer to the same query with its segments exchanged.
    #[must_use]
    pub fn turned(self) -> Self {
        match self {
            Self::First => Self::Second,
            Self::Second => Self::First,
            Self::Equal => Self::Equal,
        }
    }
}
