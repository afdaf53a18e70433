//! Somebody who answers questions, wherever they sit.

use crate::preferences::{Answer, LogEntry, Question};

/// A question that waits for an answer.
#[derive(Clone, Copy, Debug)]
pub struct Turn<'a> {
    /// What is asked.
    pub question: &'a Question,
    /// Which answer this would be, counted from 1.
    pub number: usize,
    /// How many are wanted.
    pub of: usize,
    /// Everything before it, all of it on the disk.
    pub before: &'a [LogEntry],
}

/// Nothing is left to ask.
#[derive(Clone, Copy, Debug)]
pub struct Review<'a> {
    /// Everything that was said, all of it on the disk.
    pub said: &'a [LogEntry],
    /// Why no more is asked, where answers are missing.
    pub stuck: Option<&'a str>,
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
