//! What runs on a device beside the controller: the link to a host, two slots of flash for artefacts, and the loop.
//!
//! Nothing here allocates, panics, formats text or knows a chip. A board brings a serial link, a memory-mapped flash and
//! the four methods of [`Board`]; [`serve`] does the rest. The wire is `docs/device-protocol.md`.

mod board;
pub mod cobs;
mod counters;
mod encode;
mod fly;
pub mod frame;
mod line;
pub mod message;
mod receive_artefact;
mod receiver;
mod serve;
pub mod slots;

pub use board::{Board, MappedFlash};
pub use counters::Counters;
pub use receiver::Receiver;
pub use serve::{LinkClosed, serve};
