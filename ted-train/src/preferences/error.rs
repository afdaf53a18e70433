//! Everything that can go wrong with preferences, each as what, where, and the way out.

use super::{Misfit, Query, Span};
use firmware_sim::exit::ExitCode;
use std::io;
use std::path::PathBuf;

/// Why a preference could not be had, kept or trusted.
#[derive(Debug, thiserror::Error)]
pub enum PreferenceError {
    /// A file that cannot be read.
    #[error("cannot read the preferences in {path}: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A file that cannot be written.
    #[error(
        "cannot keep the answer in {path}: {source}; the answers before it are safe, run the same command again"
    )]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The device or the quota is full.
    #[error(
        "no space left to keep the answer in {path}: free some and run the same command again, the answers before it are safe"
    )]
    DiskFull {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A line that is not a preference.
    #[error("line {line} of {path} is not a preference: {reason}; correct or delete the line")]
    Line {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1.
        line: usize,
        /// What is wrong with it.
        reason: String,
    },
    /// A line that says nothing about the dataset at hand.
    #[error(
        "line {line} of {path} does not fit: {misfit}; use the dataset that was asked about, or correct or delete the line: `ted answers` \
         with --for shows which lines fit"
    )]
    Misfit {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1.
        line: usize,
        /// What does not fit.
        misfit: Misfit,
    },
    /// A file that is no text.
    #[error(
        "{path} is not read: {reason}; save it as UTF-8 and try again, nothing of it was changed"
    )]
    NoText {
        /// The file.
        path: PathBuf,
        /// What it is instead.
        reason: String,
    },
    /// A log that no answer can be added to.
    #[error(
        "{path} is UTF-16, and answers are added in UTF-8: `ted answers {path} --merge FILE` writes all of it as UTF-8; put that in its \
         place"
    )]
    Utf16 {
        /// The log.
        path: PathBuf,
    },
    /// Another question than the one in the log at this place.
    #[error(
        "question {number} is not the one in the log: asked about {asked}, logged {logged}; either the log belongs to another seed \
         or configuration, or an answer before it was changed: delete the run's folder, and hand the answers over with --preferences"
    )]
    OtherQuestion {
        /// Its number, counted from 1.
        number: usize,
        /// What is asked now.
        asked: String,
        /// What was asked then.
        logged: String,
    },
    /// A question that a file of answers says nothing about.
    #[error(
        "{path} does not answer question {number} ({account}): add this line to it, with the answer 0 (the first is better), 1 (the second \
         is better) or 0.5 (they are equal) in place of null, which says that you cannot tell: {line}"
    )]
    NotAnswered {
        /// The file.
        path: PathBuf,
        /// The question, counted from 1.
        number: usize,
        /// What its lines were used for so far, in words.
        account: String,
        /// The question as a line of a log.
        line: String,
    },
    /// Rewards that say of no clip that it is better than another one.
    #[error(
        "the true rewards of {id} are all {reward}, so the simulated teacher cannot say which of two clips is better: answer yourself, \
         with `ted ask` or `ted train --ask`, or with --preferences and a file. It may be empty at first, and the command then says \
         the line of each question that it wants answered; README.md explains it under \"Your own answers\""
    )]
    NobodyToAsk {
        /// The dataset.
        id: String,
        /// The reward of every step.
        reward: f32,
    },
    /// Whoever was asked does not answer now.
    #[error("a question was left open: every answer is kept and the same command goes on")]
    LeftOpen,
    /// Questions enough that nobody could answer.
    #[error(
        "{untold} of {asked} questions got no answer, because whoever was asked could not tell, and there are no other pairs to ask \
         about, or ten were asked for each answer: what was said is safe in {path}; answer yourself with --preferences, ask about \
         longer clips, or ask a simulated teacher with a lower teacher.cannot_tell"
    )]
    NobodyCanTell {
        /// The log.
        path: PathBuf,
        /// Questions that were asked.
        asked: usize,
        /// Those that got no answer.
        untold: usize,
    },
}

impl PreferenceError {
    /// The exit status for a command that ends with this error.
    #[must_use]
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::Write { .. } | Self::DiskFull { .. } => ExitCode::Storage,
            Self::LeftOpen => ExitCode::Interrupted,
            _ => ExitCode::BadInput,
        }
    }
}

/// A query as it stands in an error.
pub(super) fn describe(query: &Query) -> String {
    let [first, second] = query.segments.map(Span::from);
    format!("{first} or {second}")
}
