//! `ted export`: the artefact of a finished run, made again from its state.

use std::path::PathBuf;

use clap::Args;
use firmware_sim::disk;
use firmware_sim::failure::Failure;
use firmware_sim::output::OutputArgs;
use serde::Serialize;
use ted_policy::{Artifact, ArtifactBytes};

use crate::export::{ExportError, Exported};
use crate::quantise::QuantisationReport;
use crate::run::RunFolder;
use crate::train::FinishedRun;

use super::failures::end;
use super::locate::dataset_of;

const EXAMPLES: &str = "\
Examples:
  ted export runs/drawer-open-v3/steer/seed-0
  ted export runs/drawer-open-v3/steer/seed-0 --out drawer.ted

The bytes are those that `ted train` wrote: a function of checkpoint, reward ensemble and dataset.";

/// Make the artefact of a finished run again from its checkpoint
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct ExportArgs {
    /// The run's folder
    run: PathBuf,
    /// The file to write; policy.ted in the run's folder if not given
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// The dataset, if it is no longer where the run found it
    #[arg(long)]
    dataset: Option<String>,
    #[command(flatten)]
    output: OutputArgs,
}

/// What was written.
#[derive(Debug, Serialize)]
struct Written {
    file: PathBuf,
    bytes: usize,
    crc32: String,
    /// Whether the file was there already with these bytes.
    unchanged: bool,
    /// What the integer networks in it cost.
    quantisation: QuantisationReport,
}

pub(super) fn run(args: &ExportArgs) -> Result<(), Failure> {
    let folder = RunFolder::open(&args.run).map_err(end)?;
    let dataset = dataset_of(&folder, args.dataset.as_deref())?;
    let finished = FinishedRun::read(&folder, &dataset, args.output.audience()).map_err(end)?;
    let exported = finished.artefact(&dataset).map_err(end)?;
    let file = args.out.clone().unwrap_or_else(|| folder.artefact_path());
    let unchanged = std::fs::read(&file).is_ok_and(|held| held == exported.bytes);
    match &args.out {
        Some(file) => disk::replace(file, &exported.bytes),
        None => exported.write(&folder),
    }
    .map_err(end)?;
    let Exported {
        bytes,
        quantisation,
        ..
    } = exported;
    let aligned = ArtifactBytes::from_vec(bytes);
    let artifact = Artifact::parse(&aligned)
        .map_err(|error| end(ExportError::Write(ted_policy::WriteError::Refused(error))))?;
    let written = Written {
        file,
        bytes: aligned.len(),
        crc32: format!("{:08x}", artifact.checksum()),
        unchanged,
        quantisation,
    };
    args.output.print(&written, || {
        format!(
            "{} {}: {} bytes, CRC-32 {}\n{}",
            if unchanged { "unchanged" } else { "wrote" },
            written.file.display(),
            written.bytes,
            written.crc32,
            written.quantisation
        )
    })
}
