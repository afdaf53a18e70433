//! A serial port without a chip: a pseudo-terminal of this machine, with the traits of a device's link at the board's end.

use std::ffi::OsStr;
use std::fs::File;
use std::io;
use std::os::fd::OwnedFd;
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};
use std::time::Duration;

use embedded_io::ErrorKind;
use rustix::event::PollFlags;
use rustix::fs::{Mode, OFlags};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};

use crate::wait::{Waited, wait};

/// How long the board's end waits for bytes before it says that there are none.
const WAIT: Duration = Duration::from_millis(2);

/// The board's end of a port. When it is dropped, whoever has the other end open finds the port gone.
#[derive(Debug)]
pub struct Pty {
    end: File,
    path: PathBuf,
    /// The other end, kept open: between two hosts the port is there, and nobody on it.
    _kept: OwnedFd,
}

impl Pty {
    /// A new port.
    ///
    /// # Errors
    /// When the operating system has none left.
    pub fn open() -> io::Result<Self> {
        let end = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
        grantpt(&end)?;
        unlockpt(&end)?;
        rustix::io::ioctl_fionbio(&end, true)?;
        let name = ptsname(&end, Vec::new())?;
        let path = PathBuf::from(OsStr::from_bytes(name.as_bytes()));
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC;
        Ok(Self {
            end: File::from(end),
            _kept: rustix::fs::open(&path, flags, Mode::empty())?,
            path,
        })
    }

    /// What a host opens.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl embedded_io::ErrorType for Pty {
    type Error = ErrorKind;
}

impl embedded_io::ReadReady for Pty {
    fn read_ready(&mut self) -> Result<bool, ErrorKind> {
        let waited = wait(&self.end, PollFlags::IN, WAIT);
        Ok(waited.map_err(|_| ErrorKind::Other)? == Waited::Ready)
    }
}

impl embedded_io::Read for Pty {
    fn read(&mut self, room: &mut [u8]) -> Result<usize, ErrorKind> {
        while !embedded_io::ReadReady::read_ready(self)? {}
        io::Read::read(&mut self.end, room).map_err(|_| ErrorKind::Other)
    }
}

impl embedded_io::Write for Pty {
    /// Bytes that the host does not fetch are lost, as on a cable.
    fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
        match io::Write::write(&mut self.end, bytes) {
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => Ok(bytes.len()),
            written => written.map_err(|_| ErrorKind::Other),
        }
    }

    fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
}
