//! Somebody who answers questions, wherever they sit.

use super::Did;
use crate::preferences::{Answer, LogEntry, Question};
use crate::reward::Questions;

/// A question that waits for an answer.
#[derive(Clone, Copy)]
pub struct Turn<'a> {
    /// What is asked.
    pub question: &'a Question,
    /// Which answer this would be, counted from 1.
    pub number: usize,
    /// How many are wanted.
    pub of: usize,
    /// How many were wanted before somebody wished for more.
    pub least: usize,
    /// Everything before it, all of it on the disk.
    pub before: &'a [LogEntry],
    /// Who asks, and knows what the answers did.
    pub questions: &'a dyn Questions,
}

impl Turn<'_> {
    /// What the answers before it did. Looking spends nothing.
    #[must_use]
    pub fn did(&self) -> Did {
        Did::of(self.before, self.questions.standing(self.before).as_ref())
    }

    /// Whether there are enough answers without this one.
    #[must_use]
    pub fn is_extra(&self) -> bool {
        self.number > self.least
    }
}

/// Nothing is left to ask.
#[derive(Clone, Copy)]
pub struct Review<'a> {
    /// Everything that was said, all of it on the disk.
    pub said: &'a [LogEntry],
    /// Why no more is asked, where answers are missing.
    pub stuck: Option<&'a str>,
    /// Who asked, and knows what the answers did.
    pub questions: &'a dyn Questions,
}

impl Review<'_> {
    /// What the answers did.
    #[must_use]
    pub fn did(&self) -> Did {
        Did::of(self.said, self.questions.standing(self.said).as_ref())
    }
}

/// What somebody does about a question.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reply {
    /// Answers it.
    Answer(Answer),
    /// Cannot tell.
    CannotTell,
    /// Puts it off.
    Later,
    /// Wants to be asked a question before it again: the one of this place in the log, counted from 0.
    Reopen(usize),
    /// Wants to answer five more than are wanted now.
    More,
    /// Leaves it unanswered, and all that would come after it: the answers so far are the answers, if there are enough.
    Enough,
    /// Stops for now.
    Stop,
}

/// What somebody does when nothing is left to ask.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// These are the answers.
    Done,
    /// Wants to be asked a question again: the one of this place in the log, counted from 0.
    Reopen(usize),
    /// Wants to answer five more.
    More,
    /// Stops for now.
    Stop,
}

/// Somebody who answers questions.
pub trait Person {
    /// Waits for what they say to a question.
    fn answer(&mut self, turn: Turn<'_>) -> Reply;

    /// Waits for what they say when nothing is left to ask.
    fn review(&mut self, review: Review<'_>) -> Verdict;
}
