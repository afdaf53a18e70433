//! Emulated boards: QEMU runs the firmware of `firmware-sim/firmware`, and hands out its link as a stream of bytes.
//!
//! [`Emulator::find`] and [`Firmware::find`] look for what is needed, [`Emulator::start`] gives a running [`Device`];
//! a [`Fleet`] does all three and greets the board.

mod board;
mod checks;
mod device;
mod emulator;
mod error;
mod firmware;
mod fleet;

pub use board::{Board, INSTRUCTIONS_PER_SECOND, Link, instructions};
pub use checks::{BoardCheck, diagnose};
pub use device::Device;
pub use emulator::{EMULATOR_VARIABLE, Emulator};
pub use error::QemuError;
pub use firmware::{FIRMWARE_VARIABLE, Firmware};
pub use fleet::Fleet;
