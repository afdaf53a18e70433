//! Why a person could not be asked.

use std::io;
use std::net::SocketAddr;
use std::path::PathBuf;

use firmware_sim::disk::WriteError;
use firmware_sim::exit::ExitCode;

use crate::preferences::PreferenceError;
use crate::reward::LearnError;

/// Why a person could not be asked.
#[derive(Debug, thiserror::Error)]
pub enum AskError {
    /// The answers are part of a trained run.
    #[error(
        "something was learned from the answers in {folder} already, so they cannot be changed there: ask into another folder with --out"
    )]
    Learned {
        /// The run's folder.
        folder: PathBuf,
    },
    /// The log or what was set aside.
    #[error(transparent)]
    Preference(#[from] PreferenceError),
    /// What the questions depend on.
    #[error(transparent)]
    Learn(#[from] LearnError),
    /// The disk.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// No server.
    #[error(
        "cannot listen on {address}: {source}; name another address with --listen, or use --text"
    )]
    Listen {
        /// Where it was to listen.
        address: SocketAddr,
        /// What the system said.
        source: io::Error,
    },
    /// No secret.
    #[error("the system gave no random numbers for the page's address: {0}; use --text")]
    NoSecret(String),
    /// Somebody stopped it.
    #[error("stopped: every answer is kept and the same command goes on")]
    Stopped,
}

impl AskError {
    /// The exit status for a command that ends with this error.
    #[must_use]
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::Preference(error) | Self::Learn(LearnError::Preference(error)) => {
                error.exit_code()
            }
            Self::Learn(LearnError::Interrupted) | Self::Stopped => ExitCode::Interrupted,
            Self::Learn(LearnError::Diverged { .. }) | Self::Listen { .. } | Self::NoSecret(_) => {
                ExitCode::Failure
            }
            Self::Learn(_) => ExitCode::BadInput,
            Self::Learned { .. } => ExitCode::Usage,
            Self::Write(error) => error.exit_code(),
        }
    }
}
