//! `ted export`: the artefact of a finished run, made again from its state, or its policy for other programs.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use firmware_sim::disk;
use firmware_sim::exit::ExitCode;
use firmware_sim::failure::Failure;
use firmware_sim::output::OutputArgs;
use serde::Serialize;
use ted_policy::{Artifact, ArtifactBytes};

use crate::export::{ExportError, Exported, Portable};
use crate::quantise::QuantisationReport;
use crate::run::RunFolder;
use crate::train::FinishedRun;

use super::failures::end;
use super::locate::{artefact_of, dataset_of};

const EXAMPLES: &str = "\
Examples:
  ted export runs/drawer-open-v3/steer/seed-0                    policy.ted again, from the checkpoint
  ted export runs/drawer-open-v3/steer/seed-0 --out drawer.ted
  ted export runs/drawer-open-v3/steer/seed-0 --to onnx          policy.onnx beside it
  ted export drawer.ted --to c-header --out drawer.h

The bytes of policy.ted are those that `ted train` wrote: a function of checkpoint, reward ensemble and dataset. The other formats hold \
what policy.ted holds in floats, take raw observations, and give actions in the units of the contract, which they carry. \
They do not judge, limit or stop anything: docs/export.md.";

/// Make the artefact of a finished run again, or write its policy for other programs
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct ExportArgs {
    /// The run's folder; an artefact will do where it is what is read
    run: PathBuf,
    /// What to write
    #[arg(long, value_enum, default_value_t, value_name = "FORMAT")]
    to: To,
    /// The file to write; policy.ted in the run's folder if not given, or beside the artefact with the format's ending
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// The dataset, if it is no longer where the run found it; for --to ted
    #[arg(long)]
    dataset: Option<String>,
    #[command(flatten)]
    output: OutputArgs,
}

/// What can be written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
enum To {
    /// The artefact policy.ted, made again from the checkpoint
    #[default]
    Ted,
    /// An ONNX model, with the contract in its metadata
    Onnx,
    /// Named tensors, with the contract in the metadata
    Safetensors,
    /// A header for C99 and C++ with one function, and the contract as constants
    CHeader,
}

/// The artefact that was written.
#[derive(Debug, Serialize)]
struct Written {
    to: To,
    file: PathBuf,
    bytes: usize,
    crc32: String,
    /// Whether the file was there already with these bytes.
    unchanged: bool,
    /// What the integer networks in it cost.
    quantisation: QuantisationReport,
}

/// A file for other programs that was written.
#[derive(Debug, Serialize)]
struct PortableWritten {
    to: To,
    file: PathBuf,
    bytes: usize,
    /// Whether the file was there already with these bytes.
    unchanged: bool,
    /// What it was read from.
    artefact: PathBuf,
    artefact_crc32: String,
}

pub(super) fn run(args: &ExportArgs) -> Result<(), Failure> {
    match args.to {
        To::Ted => artefact(args),
        To::Onnx => portable(args, Portable::Onnx),
        To::Safetensors => portable(args, Portable::Safetensors),
        To::CHeader => portable(args, Portable::CHeader),
    }
}

fn artefact(args: &ExportArgs) -> Result<(), Failure> {
    if args.run.is_file() {
        return Err(usage(format_args!(
            "{} is a file, and policy.ted is made from the folder of a run: name that, or say with --to what to make of an artefact",
            args.run.display()
        )));
    }
    let folder = RunFolder::open(&args.run).map_err(end)?;
    let dataset = dataset_of(&folder, args.dataset.as_deref())?;
    let finished = FinishedRun::read(&folder, &dataset, args.output.audience()).map_err(end)?;
    let exported = finished.artefact(&dataset).map_err(end)?;
    let file = args.out.clone().unwrap_or_else(|| folder.artefact_path());
    let unchanged = holds(&file, &exported.bytes);
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
        to: args.to,
        file,
        bytes: aligned.len(),
        crc32: format!("{:08x}", artifact.checksum()),
        unchanged,
        quantisation,
    };
    args.output.print(&written, || {
        format!(
            "{} {}: {} bytes, CRC-32 {}\n{}",
            did(unchanged),
            written.file.display(),
            written.bytes,
            written.crc32,
            written.quantisation
        )
    })
}

fn portable(args: &ExportArgs, format: Portable) -> Result<(), Failure> {
    if args.dataset.is_some() {
        return Err(usage(
            "--dataset is for --to ted: the other formats are made from policy.ted alone, so leave it out",
        ));
    }
    let source = match args.run.is_file() {
        true => args.run.clone(),
        false => artefact_of(&RunFolder::open(&args.run).map_err(end)?)?,
    };
    let held = ArtifactBytes::read(&source).map_err(|error| bad_input(&error))?;
    let artifact = Artifact::parse(&held).map_err(|error| {
        bad_input(format_args!(
            "{} is not a valid artefact: {error}; `ted export` with the folder of its run makes it again",
            source.display()
        ))
    })?;
    let file = (args.out.clone()).unwrap_or_else(|| source.with_extension(format.extension()));
    if same_file(&file, &source) {
        return Err(usage(format_args!(
            "{} is the artefact that is read, and would be lost: name another file with --out",
            file.display()
        )));
    }
    let bytes = format.bytes(&artifact);
    let unchanged = holds(&file, &bytes);
    disk::replace(&file, &bytes).map_err(end)?;
    let written = PortableWritten {
        to: args.to,
        file,
        bytes: bytes.len(),
        unchanged,
        artefact: source,
        artefact_crc32: format!("{:08x}", artifact.checksum()),
    };
    args.output.print(&written, || {
        format!(
            "{} {}: {} bytes, from {} with CRC-32 {}",
            did(unchanged),
            written.file.display(),
            written.bytes,
            written.artefact.display(),
            written.artefact_crc32
        )
    })
}

fn holds(file: &Path, bytes: &[u8]) -> bool {
    std::fs::read(file).is_ok_and(|held| held == bytes)
}

fn did(unchanged: bool) -> &'static str {
    if unchanged { "unchanged" } else { "wrote" }
}

fn same_file(one: &Path, other: &Path) -> bool {
    match (one.canonicalize(), other.canonicalize()) {
        (Ok(one), Ok(other)) => one == other,
        // What is not there yet is no other file.
        _ => false,
    }
}

fn usage(message: impl std::fmt::Display) -> Failure {
    Failure::new(ExitCode::Usage, message)
}

fn bad_input(message: impl std::fmt::Display) -> Failure {
    Failure::new(ExitCode::BadInput, message)
}
