//! Why answers of another program cannot be had.

use std::io;
use std::path::{Path, PathBuf};

use firmware_sim::bridge::environment::SetupError;
use firmware_sim::exit::ExitCode;

/// Why answers cannot be imported.
#[derive(Debug, thiserror::Error)]
pub enum ImportError {
    /// A file that cannot be read.
    #[error("cannot read {path}: {source}")]
    Read {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A file that is not what it should be.
    #[error("{path} cannot be imported: {reason}")]
    File {
        /// The file or folder.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A part of it that is not what it should be.
    #[error(
        "{what} {number} of {path} cannot be imported: {reason}; correct or remove it, nothing was written"
    )]
    Part {
        /// The file.
        path: PathBuf,
        /// What its parts are called.
        what: &'static str,
        /// Which of them, counted from 1.
        number: u64,
        /// What is wrong with it.
        reason: String,
    },
    /// No Python to read pickles with.
    #[error(transparent)]
    Python(#[from] SetupError),
}

impl ImportError {
    /// That a file or folder is not what it should be.
    pub(super) fn file(path: &Path, reason: impl ToString) -> Self {
        Self::File {
            path: path.to_path_buf(),
            reason: reason.to_string(),
        }
    }

    /// That a line of a file is not what it should be.
    pub(super) fn line(path: &Path, number: u64, reason: impl ToString) -> Self {
        Self::Part {
            path: path.to_path_buf(),
            what: "line",
            number,
            reason: reason.to_string(),
        }
    }

    /// The exit status for a command that ends with this error.
    #[must_use]
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::Python(error) => error.exit_code(),
            _ => ExitCode::BadInput,
        }
    }
}
