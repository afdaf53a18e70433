//! The link over two files of the host, pipes as a rule: hundreds of times as fast as a UART, in lockstep only.
//!
//! Reading waits inside the host, and the processor's clock stands still meanwhile.

use core::convert::Infallible;

use embedded_io::{ErrorKind, ErrorType, Read, ReadReady, Write};

use crate::semihosting::{self, File, Mode};

/// The word on the command line that asks for this link; the two files follow it.
const ASKED_FOR: &[u8] = b"fifo\0";

/// Both directions.
pub struct Fifo {
    from_host: File,
    to_host: File,
}

/// The host closed its end, or takes nothing any more.
#[derive(Debug)]
pub struct Closed;

impl Fifo {
    /// Opens what the host's command line names, `fifo FROM_HOST TO_HOST`; nothing if it names nothing.
    pub fn asked_for() -> Option<Self> {
        let mut line = [0; 128];
        let line = semihosting::command_line(&mut line)?;
        // Words become strings that end with zero.
        for byte in line.iter_mut().filter(|byte| **byte == b' ') {
            *byte = 0;
        }
        let (from_host, rest) = first_string(line.strip_prefix(ASKED_FOR)?)?;
        let (to_host, _) = first_string(rest)?;
        Some(Self {
            from_host: semihosting::open(from_host, Mode::Read)?,
            to_host: semihosting::open(to_host, Mode::Write)?,
        })
    }
}

/// Up to the first zero and with it, and the rest.
fn first_string(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let zero = bytes.iter().position(|byte| *byte == 0)?;
    bytes.split_at_checked(zero + 1)
}

impl core::fmt::Display for Closed {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("the host closed the link")
    }
}

impl core::error::Error for Closed {}

impl embedded_io::Error for Closed {
    fn kind(&self) -> ErrorKind {
        ErrorKind::BrokenPipe
    }
}

impl From<Infallible> for Closed {
    fn from(never: Infallible) -> Self {
        match never {}
    }
}

impl ErrorType for Fifo {
    type Error = Closed;
}

impl Read for Fifo {
    fn read(&mut self, into: &mut [u8]) -> Result<usize, Closed> {
        Ok(self.from_host.read(into))
    }
}

impl ReadReady for Fifo {
    /// Always, since nobody can be asked: the next reading waits.
    fn read_ready(&mut self) -> Result<bool, Closed> {
        Ok(true)
    }
}

impl Write for Fifo {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Closed> {
        match self.to_host.write(bytes) {
            0 if !bytes.is_empty() => Err(Closed),
            count => Ok(count),
        }
    }

    fn flush(&mut self) -> Result<(), Closed> {
        Ok(())
    }
}
