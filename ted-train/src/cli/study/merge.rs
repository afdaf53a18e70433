//! `ted study merge`: one file of scores of several.

use std::path::PathBuf;

use clap::Args;
use firmware_sim::failure::Failure;
use firmware_sim::output::OutputArgs;

use crate::cli::failures::end;
use crate::study::answers::merge;

const EXAMPLES: &str = "\
Examples:
  ted study merge docs/answers.*-of-8.jsonl --into docs/answers.jsonl
  ted study merge docs/methods.jsonl --into docs/answers.jsonl     what the other study has measured already";

/// Join files of scores of `ted study answers`, and what it can use of `ted study policies`
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct MergeArgs {
    /// Files of scores
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// The file that has all of them afterwards; what it holds already is kept
    #[arg(long, value_name = "FILE")]
    into: PathBuf,
    #[command(flatten)]
    output: OutputArgs,
}

pub(super) fn run(args: &MergeArgs) -> Result<(), Failure> {
    let merged = merge(&args.files, &args.into).map_err(end)?;
    args.output.print(&merged, || {
        format!(
            "{} scores in {}; left out: {} that were there twice, {} whose runs are none of this study",
            merged.lines,
            args.into.display(),
            merged.doubles,
            merged.foreign
        )
    })
}
