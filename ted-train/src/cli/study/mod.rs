//! `ted study`: the measurements behind the defaults and the tables of the documents.

mod answers;
mod merge;
mod policies;
mod reward;

use clap::{Args, Subcommand};
use firmware_sim::failure::Failure;

const EXAMPLES: &str = "\
Examples:
  ted study reward
  ted study policies --presets true,oprl-i+ted --set algorithm.steps=50000
  ted study answers --table";

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
    Merge(merge::MergeArgs),
}

pub(super) fn run(args: &StudyArgs) -> Result<(), Failure> {
    match &args.study {
        Study::Reward(args) => reward::run(args),
        Study::Policies(args) => policies::run(args),
        Study::Answers(args) => answers::run(args),
        Study::Merge(args) => merge::run(args),
    }
}
