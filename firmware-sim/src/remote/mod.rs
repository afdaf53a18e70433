//! The host's end of the link to a device: a controller that is somewhere else, and a way to give it another policy.
//!
//! Anything that reads and writes bytes can be the link. Its `read` must come back after a while when nothing comes, with
//! `WouldBlock` or `TimedOut`, as serial ports and sockets with a read timeout do; or a device that is not there is waited
//! for without end. The wire is `docs/device-protocol.md`.

mod connection;
mod controller;
mod error;
mod flash;
#[cfg(test)]
mod golden;
mod no_link;
mod refusal;
mod scorer;
mod stream;

pub use connection::{Connection, DeviceHello, LinkErrors, LinkOptions};
pub use controller::RemoteController;
pub use error::RemoteError;
pub use flash::{Flashed, Progress, flash};
pub use no_link::NoLink;
pub use scorer::RemoteScorer;
pub use stream::Stream;
