//! Where the controller of a flight is: on this machine, or on a board that is given the artefact.

use clap::Args;
use ted_policy::Artifact;

use super::boards::{BoardArgs, Boards};
use super::on::On;
use crate::controller::Numeric;
use crate::device::message::Start;
use crate::device::slots::SlotReport;
use crate::failure::Failure;
use crate::progress::{Audience, Progress};
use crate::remote::{Connection, RemoteError, Stream, flash};

/// The options that say where the controller is.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Where the controller is")]
pub struct SeatArgs {
    /// host, this machine; mps2-an386 (Cortex-M4F), mps2-an500 (M7) or mps2-an505 (M33), a board that QEMU emulates;
    /// serial:PORT, a board of your own, such as serial:/dev/ttyACM0. A board is sent the artefact if it flies another one
    #[arg(long, value_name = "WHERE", default_value_t = On::Host)]
    pub on: On,
    /// In which numbers it computes
    #[arg(long, value_enum, default_value_t = Numeric::F32)]
    pub numeric: Numeric,
    #[command(flatten)]
    board: BoardArgs,
}

impl SeatArgs {
    /// The boards to fly an artefact of `bytes` bytes on; none to fly on this machine. The audience hears what it will wait
    /// for.
    pub fn boards(&self, bytes: usize, audience: Audience) -> Result<Option<Boards>, Failure> {
        let boards = self.board.boards(&self.on, audience)?;
        let sent = match &boards {
            None => return Ok(None),
            Some(boards) if boards.remember() => format!("{bytes} bytes, if it holds another one"),
            Some(_) => format!("{bytes} bytes"),
        };
        audience.note(&match &self.on {
            On::Serial(path) => {
                let path = path.display();
                format!("the board at {path} is sent the artefact, {sent}")
            }
            on => format!("{on} starts in QEMU and is sent the artefact, {sent}"),
        });
        Ok(boards)
    }

    /// How episodes are flown: in lockstep with a plant, whose time stands still meanwhile.
    pub const fn start(&self) -> Start {
        Start {
            numeric: self.numeric,
            silence_us: 0,
        }
    }
}

/// A link to a board that flies this artefact, which it is sent if it holds another one. The work that waits for it shows
/// how far that is.
pub fn connect(
    boards: &Boards,
    artifact: &Artifact<'_>,
    bytes: &[u8],
    waiting: &Progress,
) -> Result<Connection<Box<dyn Stream>>, RemoteError> {
    let mut connection = boards.connect()?;
    if active_checksum(&connection) != Some(artifact.checksum()) {
        flash(&mut connection, bytes, false, |now| {
            let percent = 100 * now.sent / now.total.max(1);
            waiting.message(&format!("sending the artefact, {percent} %"));
        })?;
        waiting.message("");
    }
    Ok(connection)
}

/// The checksum of the artefact that flies on a device, if one does.
fn active_checksum(connection: &Connection<Box<dyn Stream>>) -> Option<u32> {
    connection.hello().slots.iter().find_map(|slot| match slot {
        SlotReport::Active { checksum } => Some(*checksum),
        _ => None,
    })
}
