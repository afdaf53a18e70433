//! `ted study`: the measurements behind the defaults and the tables of the documents.

mod answers;
mod d4rl;
mod merge;
mod policies;
mod reward;

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use firmware_sim::disk;
use firmware_sim::failure::Failure;

use crate::cli::failures::end;
use crate::run::REPORT;

const EXAMPLES: &str = "\
Examples:
  ted study reward
  ted study policies --presets true,oprl-i+ted --set algorithm.steps=50000
  ted study answers --table
  ted study d4rl ~/.d4rl/datasets";

/// Measure what the defaults were chosen by
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct StudyArgs {
    #[command(subcommand)]
    study: Study,
}

#[derive(Debug, Subcommand)]
enum Study {
    Reward(reward::RewardArgs),
    Policies(policies::PoliciesArgs),
    Answers(answers::AnswersArgs),
    D4rl(d4rl::D4rlArgs),
    Merge(merge::MergeArgs),
}

/// The file for a study's page: the one that was named, or report.html among its runs, but none where it was only to be printed. It
/// is known before the first run that the page can be written.
fn page(named: Option<&Path>, printed: bool, out: &Path) -> Result<Option<PathBuf>, Failure> {
    let page = match named {
        Some(named) => named.to_path_buf(),
        None if printed => return Ok(None),
        None => {
            disk::create_folder(out).map_err(end)?;
            out.join(REPORT)
        }
    };
    disk::check_writable(&page).map_err(end)?;
    Ok(Some(page))
}

pub(super) fn run(args: &StudyArgs) -> Result<(), Failure> {
    match &args.study {
        Study::Reward(args) => reward::run(args),
        Study::Policies(args) => policies::run(args),
        Study::Answers(args) => answers::run(args),
        Study::D4rl(args) => d4rl::run(args),
        Study::Merge(args) => merge::run(args),
    }
}
