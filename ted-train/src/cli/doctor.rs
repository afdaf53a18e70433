//! `ted doctor`: is everything there?

use clap::Args;
use firmware_sim::exit::ExitCode;
use firmware_sim::failure::Failure;
use firmware_sim::output::OutputArgs;

use crate::doctor::{Diagnosis, diagnose};

use super::locate::datasets_root;
use super::table::{Align, Table};

const EXAMPLES: &str = "\
Examples:
  ted doctor
  ted doctor --json

Nothing is installed or changed. Exit code 4 when something is missing; what to do stands beside it.";

/// Check processor, memory, disk, burn backends, the Python side and what emulated boards need, and say what to do about each
/// problem
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct DoctorArgs {
    #[command(flatten)]
    output: OutputArgs,
}

pub(super) fn run(args: &DoctorArgs) -> Result<(), Failure> {
    let diagnosis = diagnose(&datasets_root());
    args.output.print(&diagnosis, || text(&diagnosis))?;
    match diagnosis.problems() {
        0 => Ok(()),
        problems => Err(Failure::new(
            ExitCode::Environment,
            format_args!("{problems} of {} checks failed", diagnosis.checks.len()),
        )),
    }
}

/// The table that a person reads.
pub(super) fn text(diagnosis: &Diagnosis) -> String {
    let mut table = Table::new(&[
        ("check", Align::Left),
        ("", Align::Left),
        ("found", Align::Left),
    ]);
    for check in &diagnosis.checks {
        let mark = if check.good { "ok" } else { "PROBLEM" };
        table.row([check.name.clone(), mark.to_owned(), check.found.clone()]);
    }
    table.text()
}
