//! Bytes to and from one worker: whole frames, with a limit on how long to wait for them.

use std::io::{self, Read, Write};
use std::process::{ChildStdin, ChildStdout};
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;

use super::frame::{self, FrameError, HEADER_LEN, HELLO_LEN, Header};
use crate::interrupt;

/// How soon a request to stop is noticed while waiting for a worker.
const SLICE: Timespec = Timespec {
    tv_sec: 0,
    tv_nsec: 100_000_000,
};

/// Why nothing could be received.
#[derive(Debug)]
pub(super) enum LinkError {
    /// The worker closed its end, or it cannot be written to.
    Closed,
    /// Nothing came in time.
    Silent,
    /// What came is no frame.
    Frame(FrameError),
    /// The person asked to stop.
    Interrupted,
}

impl From<FrameError> for LinkError {
    fn from(error: FrameError) -> Self {
        Self::Frame(error)
    }
}

/// The two pipes, and buffers that are used again and again.
#[derive(Debug)]
pub(super) struct Link {
    stdin: ChildStdin,
    stdout: ChildStdout,
    outgoing: Vec<u8>,
    incoming: Vec<u8>,
}

impl Link {
    pub(super) const fn new(stdin: ChildStdin, stdout: ChildStdout) -> Self {
        Self {
            stdin,
            stdout,
            outgoing: Vec::new(),
            incoming: Vec::new(),
        }
    }

    pub(super) fn greet(&mut self, version: u32) -> Result<(), LinkError> {
        self.stdin
            .write_all(&frame::hello(version))
            .map_err(|_| LinkError::Closed)
    }

    /// The protocol version of the other side.
    pub(super) fn receive_greeting(&mut self, patience: Duration) -> Result<u32, LinkError> {
        let mut hello = [0; HELLO_LEN];
        self.read(&mut hello, Instant::now() + patience)?;
        Ok(frame::check_hello(&hello)?)
    }

    pub(super) fn send(
        &mut self,
        kind: u16,
        sequence: u32,
        payload: &[u8],
    ) -> Result<(), LinkError> {
        self.outgoing.clear();
        frame::write(&mut self.outgoing, kind, sequence, payload);
        self.stdin
            .write_all(&self.outgoing)
            .map_err(|_| LinkError::Closed)
    }

    /// The next frame; its payload stays in this link until the next one.
    pub(super) fn receive(&mut self, patience: Duration) -> Result<(Header, &[u8]), LinkError> {
        let deadline = Instant::now() + patience;
        let mut bytes = [0; HEADER_LEN];
        self.read(&mut bytes, deadline)?;
        let header = Header::parse(&bytes)?;
        let mut payload = std::mem::take(&mut self.incoming);
        payload.resize(header.length, 0);
        self.read(&mut payload, deadline)?;
        self.incoming = payload;
        header.check(&self.incoming)?;
        Ok((header, &self.incoming))
    }

    fn read(&mut self, mut into: &mut [u8], deadline: Instant) -> Result<(), LinkError> {
        while !into.is_empty() {
            self.wait(deadline)?;
            match self.stdout.read(into) {
                Ok(0) => return Err(LinkError::Closed),
                Ok(count) => into = &mut into[count..],
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(_) => return Err(LinkError::Closed),
            }
        }
        Ok(())
    }

    /// Waits until there is something to read, the patience is over, or the person asks to stop.
    fn wait(&self, deadline: Instant) -> Result<(), LinkError> {
        loop {
            match poll(
                &mut [PollFd::new(&self.stdout, PollFlags::IN)],
                Some(&SLICE),
            ) {
                Ok(0) | Err(Errno::INTR) => {}
                Ok(_) => return Ok(()),
                Err(_) => return Err(LinkError::Closed),
            }
            if interrupt::requested() {
                return Err(LinkError::Interrupted);
            }
            if Instant::now() >= deadline {
                return Err(LinkError::Silent);
            }
        }
    }
}
