//! Where the controller of a flight is: on this machine, or on an emulated board that this machine starts.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use ted_policy::Artifact;

use crate::controller::Numeric;
use crate::device::message::Start;
use crate::device::slots::SlotReport;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::progress::Audience;
use crate::qemu::{Board, Device, Fleet, Link};
use crate::remote::{Connection, RemoteError, flash};

/// The options that say where the controller is.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Where the controller is")]
pub struct SeatArgs {
    /// This machine, or a board that QEMU emulates: it is started and given the artefact over its link
    #[arg(long, value_enum, default_value_t = On::Host)]
    pub on: On,
    /// The link to the board
    #[arg(long, value_enum, default_value_t = Link::Fifo)]
    pub link: Link,
    /// In which numbers it computes
    #[arg(long, value_enum, default_value_t = Numeric::F32)]
    pub numeric: Numeric,
    /// Keep the board's flash in this file: it is not sent an artefact that it holds already
    #[arg(long, value_name = "FILE")]
    pub flash_image: Option<PathBuf>,
}

/// What may fly.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum On {
    /// This machine
    Host,
    /// An Arm Cortex-M4 with single-precision floating point
    #[value(name = "mps2-an386")]
    An386,
    /// An Arm Cortex-M7
    #[value(name = "mps2-an500")]
    An500,
    /// An Arm Cortex-M33
    #[value(name = "mps2-an505")]
    An505,
}

impl On {
    /// The board, if it is one.
    pub const fn board(self) -> Option<Board> {
        match self {
            Self::Host => None,
            Self::An386 => Some(Board::An386),
            Self::An500 => Some(Board::An500),
            Self::An505 => Some(Board::An505),
        }
    }
}

impl SeatArgs {
    /// The boards to fly an artefact of `bytes` bytes on; none to fly on this machine. The audience hears what it will wait
    /// for.
    pub fn fleet(&self, bytes: usize, audience: Audience) -> Result<Option<Fleet>, Failure> {
        let Some(board) = self.on.board() else {
            return match (&self.flash_image, self.link) {
                (None, Link::Fifo) => Ok(None),
                _ => Err(Failure::new(
                    ExitCode::Usage,
                    "--link and --flash-image belong to a board: name one with --on, or leave them out",
                )),
            };
        };
        let fleet = Fleet::find(board, self.link, self.flash_image.clone(), audience)
            .map_err(|error| Failure::new(error.exit_code(), error))?;
        audience.note(&match self.flash_image {
            None => format!("{board} starts in QEMU and is sent the artefact, {bytes} bytes"),
            Some(_) => format!(
                "{board} starts in QEMU and is sent the artefact, {bytes} bytes, if it holds another one"
            ),
        });
        Ok(Some(fleet))
    }

    /// How episodes are flown: in lockstep with a plant, whose time stands still meanwhile.
    pub const fn start(&self) -> Start {
        Start {
            numeric: self.numeric,
            silence_us: 0,
        }
    }
}

/// A link to a board of this fleet that flies this artefact, which it is sent if it holds another one.
pub fn connect(
    fleet: &Fleet,
    artifact: &Artifact<'_>,
    bytes: &[u8],
) -> Result<Connection<Device>, RemoteError> {
    let mut connection = fleet.connect()?;
    if active_checksum(&connection) != Some(artifact.checksum()) {
        flash(&mut connection, bytes, false, |_| ())?;
    }
    Ok(connection)
}

/// The checksum of the artefact that flies on a device, if one does.
fn active_checksum(connection: &Connection<Device>) -> Option<u32> {
    connection.hello().slots.iter().find_map(|slot| match slot {
        SlotReport::Active { checksum } => Some(*checksum),
        _ => None,
    })
}
