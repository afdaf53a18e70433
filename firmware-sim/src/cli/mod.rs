//! The `firmware-sim` command line: flying an artefact and saying how it went.

mod fly;
mod report;
mod toy;

use clap::{Parser, Subcommand};

use crate::exit::ExitCode;

const EXAMPLES: &str = "\
Examples:
  firmware-sim toy toy.ted && firmware-sim fly toy.ted --plant toy
  firmware-sim fly policy.ted --task drawer-open-v3 --episodes 50";

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
    Toy(toy::ToyArgs),
}

/// Runs the command of this process's arguments.
#[must_use]
pub fn run() -> ExitCode {
    let done = match Cli::parse().command {
        Command::Fly(args) => fly::run(&args),
        Command::Toy(args) => toy::run(&args),
    };
    done.unwrap_or_else(|failure| failure.tell())
}
