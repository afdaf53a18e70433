//! A serial port as a stream: raw bytes, eight bits without parity, no flow control, and nobody else on it.

use std::fs::File;
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use rustix::event::PollFlags;
use rustix::fs::{FlockOperation, Mode, OFlags, flock, open};
use rustix::io::Errno;
use rustix::termios::{
    ControlModes, InputModes, OptionalActions, QueueSelector, Termios, ioctl_tiocexcl,
    ioctl_tiocnxcl, isatty, tcflush, tcgetattr, tcsetattr,
};

use super::SerialError;
use crate::remote::NoLink;
use crate::wait::{Waited, wait};

/// How long one reading waits, if nothing else is asked for. Whoever reads knows how many are too long.
const READ_PATIENCE: Duration = Duration::from_millis(100);

/// How long a writing waits for room. A port holds several frames, and one is on its way at a time.
const WRITE_PATIENCE: Duration = Duration::from_secs(2);

/// An open port.
#[derive(Debug)]
pub struct SerialPort {
    file: File,
    path: PathBuf,
    read_patience: Duration,
}

impl SerialPort {
    /// Opens a port for this process alone, at `baud` bits a second. Bytes that came before are dropped.
    ///
    /// # Errors
    /// When there is none, it is something else, another program has it, or it cannot be set up like that.
    pub fn open(path: &Path, baud: u32) -> Result<Self, SerialError> {
        let failed = |error: Errno| SerialError::opening(path, error.into());
        // Non-blocking: a port may wait for a carrier that never comes, and a board for bytes it never reads.
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC;
        let file = File::from(open(path, flags, Mode::empty()).map_err(failed)?);
        if !isatty(&file) {
            return Err(SerialError::NoPort {
                path: path.to_owned(),
            });
        }
        // The lock keeps others out that lock, also those of root; the terminal's own mark keeps out everybody else.
        flock(&file, FlockOperation::NonBlockingLockExclusive).map_err(failed)?;
        ioctl_tiocexcl(&file).map_err(failed)?;
        let port = Self {
            file,
            path: path.to_owned(),
            read_patience: READ_PATIENCE,
        };
        let found = port.set_up(baud).map_err(failed)?;
        // A divisor is a whole number, so a real port is a little off; a receiver takes 2 %.
        if found.abs_diff(baud) > baud / 50 {
            return Err(SerialError::Speed {
                path: path.to_owned(),
                baud,
                found,
            });
        }
        Ok(port)
    }

    /// How long a reading waits before it ends with [`ErrorKind::TimedOut`]: no longer than a
    /// [`timeout`](crate::remote::LinkOptions::timeout), which can only be kept as well as that.
    pub const fn set_read_patience(&mut self, patience: Duration) {
        self.read_patience = patience;
    }

    /// Sets the port, and says at which speed it runs then.
    fn set_up(&self, baud: u32) -> rustix::io::Result<u32> {
        let mut settings = tcgetattr(&self.file)?;
        raw(&mut settings);
        settings.set_speed(baud)?;
        tcsetattr(&self.file, OptionalActions::Now, &settings)?;
        tcflush(&self.file, QueueSelector::IFlush)?;
        Ok(tcgetattr(&self.file)?.output_speed())
    }

    fn unplugged(&self) -> io::Error {
        self.reason(|path| SerialError::Unplugged { path })
    }

    fn reason(&self, of: impl FnOnce(PathBuf) -> SerialError) -> io::Error {
        NoLink::from(of(self.path.clone())).into()
    }

    fn is_ready(&self, what: PollFlags, patience: Duration) -> io::Result<bool> {
        match wait(&self.file, what, patience)? {
            Waited::Ready => Ok(true),
            Waited::TimedOut => Ok(false),
            Waited::Stopped => Err(self.reason(|path| SerialError::Interrupted { path })),
        }
    }
}

/// Bytes as they are, both ways; nothing of a modem; a reading gives what there is.
fn raw(settings: &mut Termios) {
    settings.make_raw();
    settings.input_modes -= InputModes::IXOFF | InputModes::IXANY;
    settings.control_modes -= ControlModes::CSTOPB | ControlModes::CRTSCTS;
    settings.control_modes |= ControlModes::CREAD | ControlModes::CLOCAL;
}

/// Whether nobody will ever say anything again.
fn is_gone(error: &io::Error) -> bool {
    let gone = [Errno::IO, Errno::NXIO, Errno::NODEV];
    Errno::from_io_error(error).is_some_and(|error| gone.contains(&error))
}

impl Read for SerialPort {
    /// At least one byte.
    ///
    /// # Errors
    /// [`ErrorKind::TimedOut`] when nothing comes for as long as its patience; anything else means that the port is gone or that
    /// the person asked to stop, and holds a [`NoLink`].
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        if !self.is_ready(PollFlags::IN, self.read_patience)? {
            return Err(ErrorKind::TimedOut.into());
        }
        match self.file.read(into) {
            Ok(0) if !into.is_empty() => Err(self.unplugged()),
            Err(error) if is_gone(&error) => Err(self.unplugged()),
            read => read,
        }
    }
}

impl Write for SerialPort {
    /// # Errors
    /// A [`NoLink`] when the port is gone or takes nothing, or the person asked to stop.
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if !self.is_ready(PollFlags::OUT, WRITE_PATIENCE)? {
            return Err(self.reason(|path| SerialError::Stuck { path }));
        }
        match self.file.write(bytes) {
            Err(error) if is_gone(&error) => Err(self.unplugged()),
            // There was room and is none again. Whoever writes tries once more when a writing was interrupted.
            Err(error) if error.kind() == ErrorKind::WouldBlock => {
                Err(ErrorKind::Interrupted.into())
            }
            written => written,
        }
    }

    /// Nothing: the port sends by itself what it was given.
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Drop for SerialPort {
    fn drop(&mut self) {
        // The mark would outlive this process where a third one holds the port. It is gone with the port if this fails.
        ioctl_tiocnxcl(&self.file).ok();
    }
}
