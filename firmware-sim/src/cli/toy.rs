//! `firmware-sim toy`: an artefact to try the rest with, without Python and without training.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use crate::disk;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::output::OutputArgs;
use crate::plants::toy;

/// Write the toy's artefact: a policy that was written down, not trained
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  firmware-sim toy toy.ted && firmware-sim fly toy.ted --plant toy"
)]
pub struct ToyArgs {
    /// The file to write
    out: PathBuf,
    #[command(flatten)]
    output: OutputArgs,
}

/// What was written.
#[derive(Debug, Serialize)]
struct Written {
    file: PathBuf,
    bytes: usize,
}

/// Writes the file.
pub fn run(args: &ToyArgs) -> Result<ExitCode, Failure> {
    let bytes = toy::artifact_bytes().map_err(|error| Failure::new(ExitCode::Failure, error))?;
    disk::replace(&args.out, &bytes).map_err(|error| Failure::new(error.exit_code(), error))?;
    let written = Written {
        file: args.out.clone(),
        bytes: bytes.len(),
    };
    args.output.print(&written, || {
        format!("wrote {}: {} bytes", written.file.display(), written.bytes)
    })?;
    Ok(ExitCode::Success)
}
