//! How the commands end: one number per kind of ending, the same for both binaries.

use std::process;

/// The exit status of a command. Scripts may rely on these numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum ExitCode {
    /// All was done.
    Success = 0,
    /// Something failed that has no number of its own.
    Failure = 1,
    /// The command line does not make sense.
    Usage = 2,
    /// A file given to the command is broken: artefact, dataset, configuration or preferences.
    BadInput = 3,
    /// Python, the virtual environment, the network or a simulator process is missing or failed.
    Environment = 4,
    /// Another process works on the same run folder or dataset.
    Busy = 5,
    /// The disk is full or cannot be written.
    Storage = 6,
    /// The controller latched a fault, or two computations that must agree do not.
    Faulted = 7,
    /// The person asked to stop.
    Interrupted = 130,
}

impl ExitCode {
    /// The number that the process exits with.
    #[must_use]
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// Ends the process now, without running destructors.
    pub fn exit(self) -> ! {
        process::exit(i32::from(self.code()))
    }
}

impl From<ExitCode> for process::ExitCode {
    fn from(code: ExitCode) -> Self {
        Self::from(code.code())
    }
}
