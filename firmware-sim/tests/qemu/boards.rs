//! Fleets of emulated boards, each image built once.

use std::path::Path;
use std::sync::LazyLock;

use firmware_sim::controller::Numeric;
use firmware_sim::device::message::Start;
use firmware_sim::progress::Audience;
use firmware_sim::qemu::{Board, Device, Emulator, Firmware, Fleet, Link, QemuError};
use firmware_sim::remote::{Connection, RemoteController, flash};

/// A fleet, or the reason why there is none.
pub fn fleet(board: Board, link: Link, flash_image: Option<&Path>) -> Fleet {
    match Fleet::find(
        board,
        link,
        flash_image.map(Path::to_owned),
        Audience::Nobody,
    ) {
        Ok(fleet) => fleet,
        Err(error) => panic!("failed to {error}"),
    }
}

/// The emulator and the image of the Cortex-M4F, for tests of processes.
pub fn m4() -> (Emulator, Firmware) {
    static M4: LazyLock<(Emulator, Firmware)> = LazyLock::new(|| {
        let both = || -> Result<_, QemuError> {
            Ok((
                Emulator::find()?,
                Firmware::find(Board::An386, Audience::Nobody)?,
            ))
        };
        both().unwrap_or_else(|error| panic!("failed to {error}"))
    });
    M4.clone()
}

/// A board with this artefact in its flash.
pub fn with(fleet: &Fleet, artefact: &[u8]) -> Connection<Device> {
    let mut connection = fleet.connect().expect("the board answers");
    flash(&mut connection, artefact, false, |_| ()).expect("the board takes the artefact");
    connection
}

/// A controller on a board, in lockstep.
pub fn pilot(connection: Connection<Device>, numeric: Numeric) -> RemoteController<Device> {
    let start = Start {
        numeric,
        silence_us: 0,
    };
    RemoteController::new(connection, start)
}
