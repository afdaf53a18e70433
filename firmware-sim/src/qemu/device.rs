//! A running emulator and the stream to the board in it.

use std::fs::File;
use std::io::{self, ErrorKind, Read, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, ExitStatus};
use std::thread;
use std::time::{Duration, Instant};

use rustix::event::PollFlags;

use super::{Board, QemuError};
use crate::last_words::Listener;
use crate::remote::NoLink;
use crate::wait::{Waited, wait};

/// How long one reading waits, if nothing else is asked for.
const PATIENCE: Duration = Duration::from_millis(500);

/// How long a process may take to end after it closed its streams.
const WAIT_FOR_END: Duration = Duration::from_secs(1);

/// A board in an emulator of its own, and both directions of its link.
///
/// Dropping it kills the emulator, which is what pulling the plug is to a board.
#[derive(Debug)]
pub struct Device {
    board: Board,
    child: Child,
    to_board: ChildStdin,
    from_board: ChildStdout,
    stderr: Listener,
    patience: Duration,
    /// Locked for as long as the board can write it.
    _flash: Option<File>,
}

impl Device {
    /// Starts the process. Its standard streams must be pipes.
    pub(super) fn spawn(
        command: &mut Command,
        board: Board,
        flash: Option<File>,
    ) -> io::Result<Self> {
        let mut child = command.spawn()?;
        let (Some(to_board), Some(from_board), Some(stderr)) =
            (child.stdin.take(), child.stdout.take(), child.stderr.take())
        else {
            return Err(ErrorKind::BrokenPipe.into());
        };
        Ok(Self {
            board,
            child,
            to_board,
            from_board,
            stderr: Listener::new(stderr),
            patience: PATIENCE,
            _flash: flash,
        })
    }

    /// The board.
    #[must_use]
    pub const fn board(&self) -> Board {
        self.board
    }

    /// The process id, for messages and tests.
    #[must_use]
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// How long a reading or writing waits before it ends with [`ErrorKind::TimedOut`].
    pub const fn set_patience(&mut self, patience: Duration) {
        self.patience = patience;
    }

    /// Pulls the plug.
    pub fn kill(&mut self) {
        // Both fail only for a process that is gone already.
        self.child.kill().ok();
        self.child.wait().ok();
    }

    /// The error of a link whose other end is gone, with the emulator's last words.
    fn ended(&mut self) -> io::Error {
        let status = self.own_end();
        self.kill();
        NoLink::from(QemuError::Ended {
            board: self.board,
            status: status.map_or("it closed the link".to_owned(), |s| s.to_string()),
            last_words: self.stderr.words(),
        })
        .into()
    }

    /// How the process ended by itself, if it does: its streams close a little before it can be reaped.
    fn own_end(&mut self) -> Option<ExitStatus> {
        let deadline = Instant::now() + WAIT_FOR_END;
        loop {
            match self.child.try_wait() {
                Ok(None) if Instant::now() < deadline => thread::sleep(Duration::from_millis(5)),
                status => return status.ok().flatten(),
            }
        }
    }

    fn wait(&self, readable: bool) -> io::Result<()> {
        let waited = match readable {
            true => wait(&self.from_board, PollFlags::IN, self.patience),
            false => wait(&self.to_board, PollFlags::OUT, self.patience),
        };
        let board = self.board;
        match waited? {
            Waited::Ready => Ok(()),
            Waited::TimedOut => Err(ErrorKind::TimedOut.into()),
            Waited::Stopped => Err(NoLink::from(QemuError::Interrupted { board }).into()),
        }
    }
}

impl Read for Device {
    /// At least one byte.
    ///
    /// # Errors
    /// [`ErrorKind::TimedOut`] when nothing comes for as long as its patience; anything else means that the device is gone
    /// or that the person asked to stop, and holds a [`NoLink`].
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        self.wait(true)?;
        match self.from_board.read(into) {
            Ok(0) if !into.is_empty() => Err(self.ended()),
            read => read,
        }
    }
}

impl Write for Device {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.wait(false)?;
        match self.to_board.write(bytes) {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => Err(self.ended()),
            written => written,
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        self.kill();
    }
}
