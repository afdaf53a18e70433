//! The `firmware-sim` command line: flying an artefact, saying how it went, and which flights are worth keeping.

mod artefact;
mod boards;
mod device_report;
mod flash;
mod flights;
mod fly;
mod on;
mod report;
mod score;
mod seat;
mod toy;

use clap::{Parser, Subcommand};

use crate::exit::ExitCode;

const EXAMPLES: &str = "\
Examples:
  firmware-sim toy toy.ted && firmware-sim fly toy.ted --plant toy
  firmware-sim fly policy.ted --task drawer-open-v3 --episodes 50
  firmware-sim fly policy.ted --task drawer-open-v3 --on mps2-an386 --numeric integer
  firmware-sim score policy.ted --recording flight.json";

/// Fly policies behind the controller that also runs on the device.
#[derive(Debug, Parser)]
#[command(name = "firmware-sim", version, max_term_width = 100, after_help = EXAMPLES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Fly(fly::FlyArgs),
    Flash(flash::FlashArgs),
    Score(score::ScoreArgs),
    Toy(toy::ToyArgs),
}

/// Runs the command of this process's arguments.
#[must_use]
pub fn run() -> ExitCode {
    let done = match Cli::parse().command {
        Command::Fly(args) => fly::run(&args),
        Command::Flash(args) => flash::run(&args),
        Command::Score(args) => score::run(&args),
        Command::Toy(args) => toy::run(&args),
    };
    done.unwrap_or_else(|failure| failure.tell())
}
