//! Everything that can go wrong between this program and a simulator process.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use super::frame::FrameError;
use super::message::{FaultCode, MessageError};
use crate::exit::ExitCode;
use crate::last_words::LastWords;

/// Why the bridge could not do what it was asked.
#[derive(Debug, Error)]
pub enum BridgeError {
    /// The process could not be started at all.
    #[error(
        "start the simulator with {python}: {source}; run `ted doctor` to check the installation"
    )]
    Spawn {
        /// The interpreter.
        python: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// The worker belongs to another version of this program.
    #[error(
        "talk to the simulator: it speaks protocol {actual}, this program {expected}; \
         the worker's files belong to another version of ted: {remedy}"
    )]
    ProtocolVersion {
        /// What this program speaks.
        expected: u32,
        /// What the worker speaks.
        actual: u32,
        /// What the person can do.
        remedy: String,
    },
    /// The process is running but what it sent first is no greeting.
    #[error("talk to the simulator: what was started is not a bridge worker{last_words}")]
    NotAWorker {
        /// What it said on standard error.
        last_words: LastWords,
    },
    /// The worker could not import the simulator.
    #[error("start the simulator: {message}; {remedy}{last_words}")]
    CannotStart {
        /// The import error.
        message: String,
        /// What the person can do.
        remedy: String,
        /// What it said on standard error.
        last_words: LastWords,
    },
    /// The process ended by itself.
    #[error("{during}: the simulator process ended ({status}){last_words}")]
    Died {
        /// What it was asked to do.
        during: &'static str,
        /// How it ended.
        status: String,
        /// What it said on standard error.
        last_words: LastWords,
    },
    /// The process gave no answer for too long.
    #[error("{during}: the simulator gave no answer for {seconds} s and was stopped{last_words}")]
    Silent {
        /// What it was asked to do.
        during: &'static str,
        /// How long it was given.
        seconds: u64,
        /// What it said on standard error.
        last_words: LastWords,
    },
    /// What came back is no reply of the protocol.
    #[error("{during}: the simulator's answer makes no sense: {source}{last_words}")]
    Garbled {
        /// What it was asked to do.
        during: &'static str,
        /// What is wrong with it.
        source: Nonsense,
        /// What it said on standard error.
        last_words: LastWords,
    },
    /// The worker is well but will not do this.
    #[error("{during}: the simulator refused ({code:?}): {message}")]
    Refused {
        /// What it was asked to do.
        during: &'static str,
        /// Why.
        code: FaultCode,
        /// Its words.
        message: String,
    },
    /// An episode killed one worker, and then a fresh one.
    #[error(
        "play seed {seed} of {task} on a second simulator process after the first one failed ({first}): {second}"
    )]
    FailedTwice {
        /// The task.
        task: String,
        /// The seed of the episode.
        seed: u64,
        /// How the first worker failed.
        first: Box<BridgeError>,
        /// How the second worker failed.
        second: Box<BridgeError>,
    },
    /// A task must be open for this.
    #[error("use a worker without a task: open one first")]
    NoTask,
    /// The action has another length than the task's.
    #[error("apply an action of {actual} values: the task takes {expected}")]
    ActionLength {
        /// What the task takes.
        expected: usize,
        /// What was given.
        actual: usize,
    },
    /// The world of a person says another length of its steps than the policy's contract.
    #[error(
        "fly in this world: its steps take {world} microseconds (period_us), and the policy acts every {policy}: correct one of the two"
    )]
    OtherPeriod {
        /// What the world says.
        world: u32,
        /// The control period of the contract.
        policy: u32,
    },
    /// The person asked to stop.
    #[error("stopped on request")]
    Interrupted,
}

/// What is wrong with a reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum Nonsense {
    /// It is no frame.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// It has not the layout of its kind.
    #[error(transparent)]
    Message(#[from] MessageError),
    /// It answers another request.
    #[error("it answers request {actual} instead of {expected}")]
    Sequence {
        /// The request that waits for an answer.
        expected: u32,
        /// The request that was answered.
        actual: u32,
    },
    /// It is the answer to another kind of request.
    #[error("it is of kind {actual:#04x} instead of {expected:#04x}")]
    Kind {
        /// The kind that answers the request.
        expected: u16,
        /// The kind that came.
        actual: u16,
    },
}

impl BridgeError {
    /// Whether a fresh worker may do better: the process failed, not the request.
    #[must_use]
    pub const fn is_worker_failure(&self) -> bool {
        matches!(
            self,
            Self::Died { .. } | Self::Silent { .. } | Self::Garbled { .. }
        )
    }

    /// The exit status for a command that ends with this error.
    #[must_use]
    pub const fn exit_code(&self) -> ExitCode {
        match self {
            Self::Interrupted => ExitCode::Interrupted,
            Self::OtherPeriod { .. } => ExitCode::BadInput,
            _ => ExitCode::Environment,
        }
    }
}
