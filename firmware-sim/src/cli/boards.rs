//! The boards of a command: as many emulated ones as it wants, or the one at a serial port.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Args;

use super::on::On;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::progress::Audience;
use crate::qemu::{Fleet, Link};
use crate::remote::{Connection, RemoteError, Stream};
use crate::serial::SerialBoard;

/// The speed of a serial port if none is given: one at which a tick fits a control period of 12.5 ms, and that divides the
/// clocks of most controllers.
const BAUD: u32 = 250_000;

/// The options that only a board has, and only one kind of them.
#[derive(Clone, Debug, Args)]
pub struct BoardArgs {
    /// The link to an emulated board [default: fifo]
    #[arg(long, value_enum)]
    link: Option<Link>,
    /// Keep an emulated board's flash in this file: it is not sent an artefact that it holds already
    #[arg(long, value_name = "FILE")]
    flash_image: Option<PathBuf>,
    /// Bits a second on a serial port, as the board's firmware sets them; USB ignores them [default: 250000]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1_200..=12_000_000))]
    baud: Option<u32>,
}

/// Boards to connect to.
#[derive(Debug)]
pub enum Boards {
    /// Each is started when somebody connects.
    Emulated(Fleet),
    /// It is there, once.
    Serial(SerialBoard),
}

impl BoardArgs {
    /// The boards that `on` names; none if that is this machine. Nothing is started or opened yet.
    pub fn boards(&self, on: &On, audience: Audience) -> Result<Option<Boards>, Failure> {
        let emulated = self.link.is_some() || self.flash_image.is_some();
        let usage = |message: &str| Err(Failure::new(ExitCode::Usage, message));
        match on {
            On::Host if emulated || self.baud.is_some() => usage(
                "--link, --flash-image and --baud belong to a board: name one with --on, or leave them out",
            ),
            On::Emulated(_) if self.baud.is_some() => usage(
                "--baud is the speed of a serial port, and an emulated board has none of this machine: leave it out, or name \
                 --on serial:PORT",
            ),
            On::Serial(_) if emulated => usage(
                "--link and --flash-image are QEMU's: a board of your own has its serial port and its flash, so leave them out",
            ),
            On::Host => Ok(None),
            On::Emulated(board) => {
                let link = self.link.unwrap_or_default();
                Fleet::find(*board, link, self.flash_image.clone(), audience)
                    .map(|fleet| Some(Boards::Emulated(fleet)))
                    .map_err(|error| Failure::new(error.exit_code(), error))
            }
            On::Serial(path) => SerialBoard::find(path, self.baud.unwrap_or(BAUD))
                .map(|board| Some(Boards::Serial(board)))
                .map_err(|error| Failure::new(error.exit_code(), error)),
        }
    }
}

impl Boards {
    /// A link to one of them, greeted.
    pub fn connect(&self) -> Result<Connection<Box<dyn Stream>>, RemoteError> {
        match self {
            Self::Emulated(fleet) => Ok(fleet.connect()?.boxed()),
            Self::Serial(board) => Ok(board.connect()?.boxed()),
        }
    }

    /// How many there can be at once.
    pub fn limit(&self) -> NonZeroUsize {
        match self {
            Self::Emulated(fleet) => fleet.limit(),
            Self::Serial(_) => NonZeroUsize::MIN,
        }
    }

    /// Whether they hold, after this command, what they were sent.
    pub fn remember(&self) -> bool {
        match self {
            Self::Emulated(fleet) => fleet.flash_image().is_some(),
            Self::Serial(_) => true,
        }
    }
}
