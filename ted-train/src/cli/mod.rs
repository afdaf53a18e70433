//! The `ted` command line: each command in its own file, each with `--help`, `--json` and exit codes by kind of failure.

mod answers;
mod ask;
mod bench;
mod check;
mod collect;
mod crosscheck;
mod doctor;
mod door;
mod eval;
mod export;
mod failures;
mod fleet_report;
mod import;
mod inspect;
mod locate;
mod presets;
mod quickstart;
mod report;
mod robot;
mod run_report;
mod seeds;
mod study;
mod table;
mod train;
mod worlds;

use clap::{Parser, Subcommand};
use firmware_sim::exit::ExitCode;
use firmware_sim::failure::Failure;
use firmware_sim::interrupt;

const EXAMPLES: &str = "\
A first run, all of it at reduced size:
  ted quickstart

The same step by step:
  ted collect --task drawer-open-v3
  ted check drawer-open-v3                what is odd about the logs, before a day is spent on them
  ted ask drawer-open-v3                  your own answers, on a page; leave it out and the true rewards answer
  ted train drawer-open-v3 --seed 0
  ted report runs/drawer-open-v3/steer/seed-0
  ted crosscheck runs/drawer-open-v3/steer/seed-0
  firmware-sim fly runs/drawer-open-v3/steer/seed-0/policy.ted --episodes 50

Exit codes: 0 done, 1 other failure, 2 usage, 3 bad input file, 4 Python or simulator, 5 folder in use, \
6 disk, 7 fault or mismatch, 130 interrupted.";

/// From logs and ten preferences to a policy that flies on a microcontroller.
#[derive(Debug, Parser)]
#[command(name = "ted", version, max_term_width = 100, after_help = EXAMPLES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Quickstart(quickstart::QuickstartArgs),
    Doctor(doctor::DoctorArgs),
    Collect(collect::CollectArgs),
    Import(import::ImportArgs),
    Check(check::CheckArgs),
    Ask(ask::AskArgs),
    Train(train::TrainArgs),
    Answers(answers::AnswersArgs),
    Eval(eval::EvalArgs),
    Export(export::ExportArgs),
    Inspect(inspect::InspectArgs),
    Crosscheck(crosscheck::CrosscheckArgs),
    Report(report::ReportArgs),
    Robot(robot::RobotArgs),
    Worlds(worlds::WorldsArgs),
    Bench(bench::BenchArgs),
    Study(study::StudyArgs),
}

/// Runs the command of this process's arguments.
#[must_use]
pub fn run() -> ExitCode {
    let cli = Cli::parse();
    let caught = interrupt::install().map_err(|error| {
        Failure::new(
            ExitCode::Failure,
            format_args!("cannot catch Ctrl-C: {error}"),
        )
    });
    let done = caught.and_then(|()| match cli.command {
        Command::Quickstart(args) => quickstart::run(&args),
        Command::Doctor(args) => doctor::run(&args),
        Command::Collect(args) => collect::run(&args),
        Command::Import(args) => import::run(&args),
        Command::Check(args) => check::run(&args),
        Command::Ask(args) => ask::run(&args),
        Command::Train(args) => train::run(&args),
        Command::Answers(args) => answers::run(&args),
        Command::Eval(args) => eval::run(&args),
        Command::Export(args) => export::run(&args),
        Command::Inspect(args) => inspect::run(&args),
        Command::Crosscheck(args) => crosscheck::run(&args),
        Command::Report(args) => report::run(&args),
        Command::Robot(args) => robot::run(&args),
        Command::Worlds(args) => worlds::run(&args),
        Command::Bench(args) => bench::run(&args),
        Command::Study(args) => study::run(&args),
    });
    match done {
        Ok(()) => ExitCode::Success,
        Err(failure) => failure.tell(),
    }
}
