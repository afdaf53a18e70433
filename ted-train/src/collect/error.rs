//! Why a collection ended early.

use crate::dataset::WriteError;
use firmware_sim::bridge::BridgeError;
use firmware_sim::exit::ExitCode;
use firmware_sim::tasks::UnknownTask;

/// Why a collection ended early. Whatever was complete by then is kept.
#[derive(Debug, thiserror::Error)]
pub enum CollectError {
    /// No such task.
    #[error(transparent)]
    Task(#[from] UnknownTask),
    /// No such recipe.
    #[error("no recipe `{name}`: the recipes are {known}")]
    Recipe {
        /// What was asked for.
        name: String,
        /// What there is.
        known: String,
    },
    /// A dataset of nothing.
    #[error("a dataset needs at least one episode")]
    NoEpisodes,
    /// The simulator failed.
    #[error(transparent)]
    Bridge(#[from] BridgeError),
    /// The dataset cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The person asked to stop.
    #[error(
        "stopped on request with {done} of {total} episodes complete; the same command goes on from there"
    )]
    Interrupted {
        /// Episodes on the disk.
        done: usize,
        /// Episodes asked for.
        total: u32,
    },
}

impl CollectError {
    /// The exit status for a command that ends with this error.
    #[must_use]
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::Task(_) | Self::Recipe { .. } | Self::NoEpisodes => ExitCode::Usage,
            Self::Bridge(error) => error.exit_code(),
            Self::Write(WriteError::Busy { .. }) => ExitCode::Busy,
            Self::Write(WriteError::DiskFull { .. } | WriteError::Io { .. }) => ExitCode::Storage,
            Self::Write(WriteError::Different { .. } | WriteError::Episode(_)) => {
                ExitCode::BadInput
            }
            Self::Interrupted { .. } => ExitCode::Interrupted,
        }
    }
}
