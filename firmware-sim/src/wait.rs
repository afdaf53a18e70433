//! Waits for one end of a stream, and notices meanwhile that the person asked to stop.

use std::io;
use std::os::fd::AsFd;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;

use crate::interrupt;

/// How soon a request to stop is noticed.
const SLICE: Duration = Duration::from_millis(100);

/// How the waiting ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Waited {
    /// There is something to do, or the other end is gone, which the next reading or writing will say.
    Ready,
    /// Nothing happened for so long.
    TimedOut,
    /// The person asked to stop.
    Stopped,
}

/// Waits until `fd` can be read or written, as `what` says, but no longer than `patience`.
///
/// # Errors
/// When the operating system cannot say.
pub(crate) fn wait(fd: impl AsFd, what: PollFlags, patience: Duration) -> io::Result<Waited> {
    let deadline = Instant::now() + patience;
    loop {
        let left = deadline.saturating_duration_since(Instant::now());
        let slice = left.min(SLICE);
        let slice = Timespec {
            tv_sec: 0,
            tv_nsec: slice.subsec_nanos().into(),
        };
        match poll(&mut [PollFd::new(&fd, what)], Some(&slice)) {
            Ok(0) | Err(Errno::INTR) => {}
            Ok(_) => return Ok(Waited::Ready),
            Err(error) => return Err(error.into()),
        }
        if interrupt::requested() {
            return Ok(Waited::Stopped);
        }
        if left.is_zero() {
            return Ok(Waited::TimedOut);
        }
    }
}
