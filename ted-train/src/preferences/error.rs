//! Everything that can go wrong with preferences, each as what, where, and the way out.

use super::Query;
use crate::dataset::SegmentError;
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
    /// An answer that is none.
    #[error(
        "line {line} of {path} has the answer {answer}, which is not 0 (first better), 1 (second better), 0.5 (equal) or null (whoever was asked could not tell); correct or delete the line"
    )]
    Answer {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1.
        line: usize,
        /// What stands there.
        answer: f64,
    },
    /// A preference about other data.
    #[error(
        "line {line} of {path} is about {logged}, and this is {actual}; use the dataset the questions were asked about, or \
         another preference file"
    )]
    OtherDataset {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1.
        line: usize,
        /// Id and digest of the dataset in the line.
        logged: String,
        /// Id and digest of the dataset at hand.
        actual: String,
    },
    /// A preference about steps that the dataset does not have.
    #[error("line {line} of {path}: {source}; correct or delete the line")]
    Segment {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1.
        line: usize,
        /// What does not fit.
        source: SegmentError,
    },
    /// Another question than the one in the log at this place.
    #[error(
        "question {number} is not the one in the log: asked about {asked}, logged {logged}; either the log belongs to another seed \
         or configuration, or an answer before it was changed: then put the question asked now into line {number} and answer it"
    )]
    OtherQuestion {
        /// Its number, counted from 1.
        number: usize,
        /// What is asked now.
        asked: String,
        /// What was asked then.
        logged: String,
    },
    /// A replay that has come to its end.
    #[error(
        "the replayed log has {answers} answers and question {number} was asked; ask fewer, or add this line to it, with the answer 0 \
         (the first is better), 1 (the second is better) or 0.5 (they are equal) in place of null, which says that you cannot \
         tell: {line}"
    )]
    ReplayExhausted {
        /// How many answers it has.
        answers: usize,
        /// The question, counted from 1.
        number: usize,
        /// The question as a line of a log.
        line: String,
    },
    /// Rewards that say of no clip that it is better than another one.
    #[error(
        "the true rewards of {id} are all {reward}, so the simulated teacher cannot say which of two clips is better: answer yourself, \
         with --preferences and a file. It may be empty at first, and the command then says the line of each question that it \
         wants answered; README.md explains it under \"Your own answers\""
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
    let [first, second] = query.segments.map(|segment| {
        format!(
            "episode {} steps {}..{}",
            segment.episode(),
            segment.start(),
            segment.start() + segment.len()
        )
    });
    format!("{first} or {second}")
}
