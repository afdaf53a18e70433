//! The `ted` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    ted_train::cli::run().into()
}
