//! Every fault there is, on every core: the answers are those of `tests/device_fault_table.txt`, word for word.

use std::path::Path;
use std::time::Duration;
use std::{fs, io};

use firmware_sim::bench::drill::{Rig, drill, table};
use firmware_sim::progress::Audience;
use firmware_sim::qemu::{Board, Device, Emulator, Firmware, Link};
use firmware_sim::remote::LinkOptions;
use tempfile::TempDir;

/// What a device thread's table says, which is every core's too.
const TABLE: &str = include_str!("../device_fault_table.txt");

/// Bytes of flash on every board.
const FLASH_BYTES: usize = 16 * 1024 * 1024;

/// A board, and a file that is its flash.
struct Emulated {
    emulator: Emulator,
    firmware: Firmware,
    folder: TempDir,
}

impl Rig for Emulated {
    type Link = Device;

    fn flash_bytes(&self) -> usize {
        FLASH_BYTES
    }

    fn power_on(&mut self, flash: &[u8]) -> io::Result<Device> {
        let image = self.folder.path().join("flash");
        fs::write(&image, flash)?;
        // Over the serial port: the faster link knows no silence, as its reading waits for the host.
        self.emulator
            .start(&self.firmware, Link::Uart, Some(&image))
            .map_err(io::Error::other)
    }

    fn link_options(&self) -> LinkOptions {
        LinkOptions {
            timeout: Duration::from_secs(2),
            tries: 10,
            session: 1,
        }
    }
}

fn table_of(board: Board) -> String {
    let found = || {
        let (emulator, firmware) = (Emulator::find()?, Firmware::find(board, Audience::Nobody)?);
        Ok::<_, firmware_sim::qemu::QemuError>((emulator, firmware))
    };
    let (emulator, firmware) = found().unwrap_or_else(|error| panic!("failed to {error}"));
    let mut rig = Emulated {
        emulator,
        firmware,
        folder: tempfile::tempdir_in(Path::new(env!("CARGO_TARGET_TMPDIR"))).unwrap(),
    };
    table(&drill(&mut rig).unwrap())
}

fn same_rows(board: Board) {
    let found = table_of(board);
    let (_, expected) = TABLE.split_once("\n\n").unwrap();
    for (found, expected) in found.lines().zip(expected.lines()) {
        assert_eq!(found, expected, "{}", board.name());
    }
    assert_eq!(found.lines().count(), expected.lines().count());
}

#[test]
fn the_m4_answers_every_fault_as_the_table_says() {
    same_rows(Board::An386);
}

#[test]
fn the_m7_answers_every_fault_as_the_table_says() {
    same_rows(Board::An500);
}

#[test]
fn the_m33_answers_every_fault_as_the_table_says() {
    same_rows(Board::An505);
}
