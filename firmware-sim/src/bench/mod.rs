//! A device without a chip, for tests and demonstrations: flash in memory that can lose its power, a cable in memory that
//! can be disturbed, and a thread that serves at its end.

mod cable;
mod disturbed;
pub mod drill;
mod host_board;
mod host_device;
mod memory_flash;

pub use cable::{Cable, cable};
pub use disturbed::{Direction, Disturbance, Disturbed, Strike};
pub use host_board::HostBoard;
pub use host_device::HostDevice;
pub use memory_flash::{FlashFault, MemoryFlash};
