//! A question that was asked, and what was said: what a run remembers of an answer.

use super::{Answer, Question};

/// Which part of the procedure asks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Context {
    /// The round of questions, 0 for the initial ones.
    pub round: u32,
    /// The ensemble member that asks for itself alone; none when all share the answer.
    pub member: Option<u32>,
}

/// What was said to a question.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Said {
    /// The answer; none when whoever was asked could not tell.
    pub answer: Option<Answer>,
    /// Whether there is no answer because the question was put off.
    pub later: bool,
    /// Who was asked.
    pub by: String,
    /// When, as whoever wrote it down put it; none where nobody did.
    pub at: Option<String>,
}

/// A question that was asked, and what was said.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogEntry {
    /// The question.
    pub question: Question,
    /// What was said to it.
    pub said: Said,
}
