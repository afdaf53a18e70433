//! The artefact that a command is given.

use std::path::Path;

use ted_policy::{Artifact, ArtifactBytes};

use crate::exit::ExitCode;
use crate::failure::Failure;

/// Its bytes.
pub fn read(path: &Path) -> Result<ArtifactBytes, Failure> {
    ArtifactBytes::read(path).map_err(|error| Failure::new(ExitCode::BadInput, error))
}

/// What is in them.
pub fn parse<'b>(bytes: &'b ArtifactBytes, path: &Path) -> Result<Artifact<'b>, Failure> {
    Artifact::parse(bytes).map_err(|error| {
        Failure::new(
            ExitCode::BadInput,
            format_args!("read {}: {error}", path.display()),
        )
    })
}
