//! What a command prints, and for whom. A reader that leaves early, as `head` does, stops no work.

use std::io::{self, Write};

use clap::Args;
use serde::Serialize;

use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::progress::Audience;

/// The options that every command has.
#[derive(Clone, Copy, Debug, Args)]
pub struct OutputArgs {
    /// Print one JSON object on standard output, and no progress
    #[arg(long)]
    json: bool,
    /// Show no progress
    #[arg(long)]
    quiet: bool,
}

impl OutputArgs {
    /// Who sees the progress.
    #[must_use]
    pub fn audience(self) -> Audience {
        Audience::detect(self.json || self.quiet)
    }

    /// Prints a result: as JSON, or as the text that a person reads.
    ///
    /// # Errors
    /// When standard output cannot be written, but not when its reader has seen enough and left.
    pub fn print(
        self,
        value: &impl Serialize,
        text: impl FnOnce() -> String,
    ) -> Result<(), Failure> {
        let text = if self.json {
            serde_json::to_string_pretty(value).map_err(|e| Failure::new(ExitCode::Failure, e))?
        } else {
            text()
        };
        match writeln!(io::stdout(), "{text}") {
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
            Err(error) => Err(Failure::new(
                ExitCode::Storage,
                format_args!("cannot write the result: {error}"),
            )),
            Ok(()) => Ok(()),
        }
    }
}
