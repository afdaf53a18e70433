//! `ted study`: the measurements behind the defaults and the tables of the documents.

mod policies;
mod reward;

use clap::{Args, Subcommand};
use firmware_sim::failure::Failure;

const EXAMPLES: &str = "\
Examples:
  ted study reward
  ted study policies --presets true,oprl-i+ted --set algorithm.steps=50000";

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
}

pub(super) fn run(args: &StudyArgs) -> Result<(), Failure> {
    match &args.study {
        Study::Reward(args) => reward::run(args),
        Study::Policies(args) => policies::run(args),
    }
}
