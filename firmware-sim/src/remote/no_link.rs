//! Why there is no link to a device, or none any more, said by whoever provides it.

use std::error::Error;
use std::io;

use thiserror::Error;

use crate::exit::ExitCode;

/// A reason that knows how a command ends with it. A stream that has one puts it into its [`io::Error`].
#[derive(Debug, Error)]
#[error("{source}")]
pub struct NoLink {
    code: ExitCode,
    source: Box<dyn Error + Send + Sync>,
}

impl NoLink {
    /// This reason.
    pub fn new(code: ExitCode, reason: impl Error + Send + Sync + 'static) -> Self {
        Self {
            code,
            source: Box::new(reason),
        }
    }

    /// How a command ends that fails with it.
    #[must_use]
    pub const fn exit_code(&self) -> ExitCode {
        self.code
    }
}

impl From<NoLink> for io::Error {
    fn from(reason: NoLink) -> Self {
        Self::other(reason)
    }
}
