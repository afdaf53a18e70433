//! `firmware-sim toy`: an artefact to try the rest with, without Python and without training.

use std::fs;
use std::path::PathBuf;

use clap::Args;

use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::plants::toy;

/// Write the toy's artefact: a policy that was written down, not trained
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  firmware-sim toy toy.ted && firmware-sim fly toy.ted --plant toy"
)]
pub struct ToyArgs {
    /// The file to write
    out: PathBuf,
}

/// Writes the file.
pub fn run(args: &ToyArgs) -> Result<ExitCode, Failure> {
    let bytes = toy::artifact_bytes().map_err(|error| Failure::new(ExitCode::Failure, error))?;
    let out = args.out.display();
    fs::write(&args.out, bytes)
        .map_err(|error| Failure::new(ExitCode::Storage, format_args!("write {out}: {error}")))?;
    Ok(ExitCode::Success)
}
