//! The link of this run: the host's files if there is a host that offers them, else the UART.

use embedded_io::{ErrorType, Read, ReadReady, Write};

use crate::fifo::{Closed, Fifo};
use crate::uart::Uart;

/// Either link.
pub enum Link {
    /// Files of the host.
    Fifo(Fifo),
    /// The board's UART.
    Uart(Uart),
}

impl Link {
    /// Opens it.
    pub fn open() -> Self {
        match Fifo::asked_for() {
            Some(fifo) => Self::Fifo(fifo),
            None => Self::Uart(Uart::start()),
        }
    }
}

impl ErrorType for Link {
    type Error = Closed;
}

impl Read for Link {
    fn read(&mut self, into: &mut [u8]) -> Result<usize, Closed> {
        match self {
            Self::Fifo(fifo) => fifo.read(into),
            Self::Uart(uart) => Ok(uart.read(into)?),
        }
    }
}

impl ReadReady for Link {
    fn read_ready(&mut self) -> Result<bool, Closed> {
        match self {
            Self::Fifo(fifo) => fifo.read_ready(),
            Self::Uart(uart) => Ok(uart.read_ready()?),
        }
    }
}

impl Write for Link {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Closed> {
        match self {
            Self::Fifo(fifo) => fifo.write(bytes),
            Self::Uart(uart) => Ok(uart.write(bytes)?),
        }
    }

    fn flush(&mut self) -> Result<(), Closed> {
        match self {
            Self::Fifo(fifo) => fifo.flush(),
            Self::Uart(uart) => Ok(uart.flush()?),
        }
    }
}
