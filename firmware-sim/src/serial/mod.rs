//! A board of one's own at a serial port: over a cable, an adapter, or USB.
//!
//! [`SerialBoard::find`] looks for the port, [`SerialBoard::connect`] opens it and greets the board. A [`SerialPort`] is the
//! stream alone.

mod board;
mod error;
mod port;

pub use board::SerialBoard;
pub use error::SerialError;
pub use port::SerialPort;
