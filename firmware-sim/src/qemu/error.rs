//! Why no emulated board could be had, or why it is gone.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use super::board::FLASH_BYTES;
use super::{Board, EMULATOR_VARIABLE, FIRMWARE_VARIABLE};
use crate::exit::ExitCode;
use crate::last_words::LastWords;
use crate::remote::NoLink;

/// What went wrong with an emulated board.
#[derive(Debug, Error)]
pub enum QemuError {
    /// There is no QEMU, or it cannot be run.
    #[error(
        "run {path}: {source}; install QEMU for Arm (on Debian and Ubuntu: apt install qemu-system-arm), or name it with \
         {EMULATOR_VARIABLE}=/path/to/qemu-system-arm"
    )]
    NoEmulator {
        /// What was looked for.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// It is no QEMU, or one that nobody tried.
    #[error(
        "use {path}: it says {words:?}, QEMU {oldest} or newer is needed; name another one with \
         {EMULATOR_VARIABLE}=/path/to/qemu-system-arm"
    )]
    UnfitEmulator {
        /// The program.
        path: PathBuf,
        /// What it said of itself.
        words: String,
        /// The oldest version that will do.
        oldest: u32,
    },
    /// The named folder has no image of the board.
    #[error(
        "find the firmware {path}: there is no such file; {FIRMWARE_VARIABLE} names its folder"
    )]
    NoImage {
        /// Where it should be.
        path: PathBuf,
    },
    /// Nothing to build an image from.
    #[error(
        "build the firmware of {board}: the sources of this program are not on this machine; name a folder with \
         {board}.elf in {FIRMWARE_VARIABLE}"
    )]
    NoSources {
        /// The board.
        board: Board,
    },
    /// The script that builds images does not run.
    #[error("run {script}: {source}")]
    Script {
        /// The script.
        script: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// The image was not built.
    #[error("build the firmware of {board}: {words}")]
    NotBuilt {
        /// The board.
        board: Board,
        /// What the script said.
        words: String,
    },
    /// The person asked to stop while an image was built.
    #[error("build the firmware of {board}: stopped on request")]
    BuildInterrupted {
        /// The board.
        board: Board,
    },
    /// The file of the flash cannot be made or written.
    #[error("open the flash image {path}: {source}")]
    FlashImage {
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// The file is something else.
    #[error(
        "use the flash image {path}: it has {found} bytes and a flash {FLASH_BYTES}, so it is something else and is left \
         alone; name a file that is not there yet"
    )]
    NoFlashImage {
        /// The file.
        path: PathBuf,
        /// Its length in bytes.
        found: u64,
    },
    /// Another board runs from the file.
    #[error(
        "use the flash image {path}: another board runs from it; wait for its end, or name another file"
    )]
    FlashInUse {
        /// The file.
        path: PathBuf,
    },
    /// The operating system does not start it.
    #[error("start {path}: {source}")]
    Spawn {
        /// The emulator.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// The emulator ended.
    #[error("talk to {board} in QEMU: it ended ({status}){last_words}")]
    Ended {
        /// The board.
        board: Board,
        /// How.
        status: String,
        /// What it said last.
        last_words: LastWords,
    },
    /// The person asked to stop.
    #[error("talk to {board} in QEMU: stopped on request")]
    Interrupted {
        /// The board.
        board: Board,
    },
}

impl QemuError {
    /// How a command ends that fails with this error.
    #[must_use]
    pub const fn exit_code(&self) -> ExitCode {
        match self {
            Self::Interrupted { .. } | Self::BuildInterrupted { .. } => ExitCode::Interrupted,
            Self::FlashInUse { .. } => ExitCode::Busy,
            Self::FlashImage { .. } => ExitCode::Storage,
            Self::NoFlashImage { .. } => ExitCode::BadInput,
            _ => ExitCode::Environment,
        }
    }
}

impl From<QemuError> for NoLink {
    fn from(error: QemuError) -> Self {
        Self::new(error.exit_code(), error)
    }
}
