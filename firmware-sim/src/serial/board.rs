//! Greets the board at the other end of a serial port, and knows how long to wait for it.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::{SerialError, SerialPort};
use crate::device::frame::{MAX_FRAME, MAX_REPLY_FRAME};
use crate::remote::{Connection, LinkOptions, RemoteError};

/// How long a board may take to answer anything, all tries together. It judges what is in its slots before it answers the
/// first greeting, and an artefact before it puts it into service: some seconds for a full-size one at 168 MHz. A sector of
/// 128 KiB takes up to four seconds to erase, and a board that is reset by the opening of its port has to start first.
const PATIENCE: Duration = Duration::from_secs(30);

/// How long a board may take to compute one answer before it is asked again. Longer than any tick, so that nothing is
/// repeated on a line that loses nothing; on one that does, a lost frame costs this much.
const COMPUTING: Duration = Duration::from_secs(1);

/// A start bit, eight bits and a stop bit.
const BITS_PER_BYTE: u32 = 10;

/// Where a board is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SerialBoard {
    path: PathBuf,
    baud: u32,
}

impl SerialBoard {
    /// A board at the port `path`, which runs at `baud` bits a second unless it is USB. The port is not opened yet: that
    /// resets some boards.
    ///
    /// # Errors
    /// When there is no such port.
    pub fn find(path: &Path, baud: u32) -> Result<Self, SerialError> {
        fs::metadata(path).map_err(|source| SerialError::opening(path, source))?;
        Ok(Self {
            path: path.to_owned(),
            baud,
        })
    }

    /// The port.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Opens the port and greets the board.
    ///
    /// # Errors
    /// When the port cannot be had, or nobody answers.
    pub fn connect(&self) -> Result<Connection<SerialPort>, RemoteError> {
        let port = SerialPort::open(&self.path, self.baud)
            .map_err(|error| RemoteError::NoLink(error.into()))?;
        Connection::open(port, link_options(self.baud))
    }
}

/// A try waits for the longest request, what is computed, and the longest reply.
fn link_options(baud: u32) -> LinkOptions {
    let bits = BITS_PER_BYTE * (1 + MAX_FRAME + MAX_REPLY_FRAME) as u32;
    let timeout = COMPUTING + Duration::from_secs(1) * bits / baud.max(1);
    LinkOptions {
        timeout,
        tries: PATIENCE.div_duration_f64(timeout).ceil() as u32,
        ..LinkOptions::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_try_is_as_long_as_its_bytes_take_and_all_together_are_patient_enough() {
        // 788 bytes of frames at most.
        for (baud, millis, tries) in [(250_000, 1_031, 30), (9_600, 1_820, 17), (1_200, 7_566, 4)] {
            let options = link_options(baud);
            assert_eq!(options.timeout.as_millis(), millis, "{baud}");
            assert_eq!(options.tries, tries, "{baud}");
        }
    }
}
