//! How a command fails: a line for the person and a number for the script.

use std::fmt::Display;

use crate::bridge::BridgeError;
use crate::exit::ExitCode;
use crate::plant::PlantError;
use crate::rollout::FlyError;

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
        eprintln!("error: {}", self.message);
        self.code
    }
}

impl From<FlyError> for Failure {
    fn from(error: FlyError) -> Self {
        let code = match &error {
            FlyError::Load(_) => ExitCode::BadInput,
            FlyError::NoPlant(source) | FlyError::Episode { source, .. } => plant_code(source),
            FlyError::Interrupted { .. } => ExitCode::Interrupted,
        };
        Self::new(code, error)
    }
}

impl From<PlantError> for Failure {
    fn from(error: PlantError) -> Self {
        Self::new(plant_code(&error), error)
    }
}

fn plant_code(error: &PlantError) -> ExitCode {
    match error {
        PlantError::Link(source) => source
            .downcast_ref::<BridgeError>()
            .map_or(ExitCode::Environment, BridgeError::exit_code),
        PlantError::ActionLength { .. } | PlantError::NoRecording { .. } => ExitCode::BadInput,
        PlantError::NoEpisode => ExitCode::Failure,
    }
}
