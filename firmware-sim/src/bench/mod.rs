//! A device without a chip, for tests and demonstrations: flash in memory that can lose its power, a cable in memory that
//! can be disturbed, a serial port that is a pseudo-terminal, and a thread that serves at its end.

mod cable;
mod disturbed;
pub mod drill;
mod host_board;
mod host_device;
mod memory_flash;
mod pty;

pub use cable::{Cable, cable};
pub use disturbed::{Direction, Disturbance, Disturbed, Strike};
pub use host_board::HostBoard;
pub use host_device::HostDevice;
pub use memory_flash::{FlashFault, MemoryFlash};
pub use pty::Pty;
