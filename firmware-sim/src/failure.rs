//! How a command fails: a line for the person and a number for the script.

use std::fmt::Display;

use crate::exit::ExitCode;
use crate::plant::PlantError;
use crate::progress::tell;
use crate::remote::RemoteError;
use crate::rollout::{EpisodeError, FlyError};
use crate::scoring::ScoreError;

/// What went wrong, and what kind of thing that is.
#[derive(Debug)]
pub struct Failure {
    code: ExitCode,
    message: String,
}

impl Failure {
    /// A failure of this kind.
    pub fn new(code: ExitCode, message: impl Display) -> Self {
        Self {
            code,
            message: message.to_string(),
        }
    }

    /// Says it on standard error.
    pub fn tell(self) -> ExitCode {
        tell(&format!("error: {}", self.message));
        self.code
    }
}

impl From<FlyError> for Failure {
    fn from(error: FlyError) -> Self {
        Self::new(error.exit_code(), error)
    }
}

impl From<PlantError> for Failure {
    fn from(error: PlantError) -> Self {
        Self::new(error.exit_code(), error)
    }
}

impl From<EpisodeError> for Failure {
    fn from(error: EpisodeError) -> Self {
        Self::new(error.exit_code(), error)
    }
}

impl From<ScoreError> for Failure {
    fn from(error: ScoreError) -> Self {
        Self::new(error.exit_code(), error)
    }
}

impl From<RemoteError> for Failure {
    fn from(error: RemoteError) -> Self {
        Self::new(error.exit_code(), error)
    }
}
