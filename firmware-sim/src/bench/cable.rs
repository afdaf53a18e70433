//! A serial cable in memory: two ends, each with the traits of a host's stream and of a device's link.

use std::collections::VecDeque;
use std::convert::Infallible;
use std::io;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// How long an end waits for bytes before it says that there are none.
const WAIT: Duration = Duration::from_millis(2);

/// One end of a cable. When it is dropped, the other end reads what is left, and then nothing.
#[derive(Debug)]
pub struct Cable {
    inward: Arc<Wire>,
    outward: Arc<Wire>,
}

/// One direction.
#[derive(Debug, Default)]
struct Wire {
    state: Mutex<State>,
    arrived: Condvar,
}

#[derive(Debug, Default)]
struct State {
    bytes: VecDeque<u8>,
    cut: bool,
}

/// Two ends of one cable.
#[must_use]
pub fn cable() -> (Cable, Cable) {
    let (there, back) = (Arc::<Wire>::default(), Arc::<Wire>::default());
    let near = Cable {
        inward: Arc::clone(&back),
        outward: Arc::clone(&there),
    };
    let far = Cable {
        inward: there,
        outward: back,
    };
    (near, far)
}

impl Wire {
    fn state(&self) -> MutexGuard<'_, State> {
        // Bytes are whole whatever became of the thread at the other end.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for bytes; whether there are any, or never will be.
    fn wait(&self) -> bool {
        let empty = |state: &mut State| state.bytes.is_empty() && !state.cut;
        let waited = self.arrived.wait_timeout_while(self.state(), WAIT, empty);
        !waited.unwrap_or_else(PoisonError::into_inner).1.timed_out()
    }

    fn take(&self, room: &mut [u8]) -> usize {
        let bytes = &mut self.state().bytes;
        let length = room.len().min(bytes.len());
        for (place, byte) in room.iter_mut().zip(bytes.drain(..length)) {
            *place = byte;
        }
        length
    }

    fn put(&self, bytes: &[u8]) {
        self.state().bytes.extend(bytes);
        self.arrived.notify_all();
    }

    fn cut(&self) {
        self.state().cut = true;
        self.arrived.notify_all();
    }
}

impl Drop for Cable {
    fn drop(&mut self) {
        self.inward.cut();
        self.outward.cut();
    }
}

impl io::Read for Cable {
    fn read(&mut self, room: &mut [u8]) -> io::Result<usize> {
        if self.inward.wait() {
            Ok(self.inward.take(room))
        } else {
            Err(io::ErrorKind::TimedOut.into())
        }
    }
}

impl io::Write for Cable {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.outward.state().cut {
            return Err(io::ErrorKind::BrokenPipe.into());
        }
        self.outward.put(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl embedded_io::ErrorType for Cable {
    type Error = Infallible;
}

impl embedded_io::ReadReady for Cable {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        Ok(self.inward.wait())
    }
}

impl embedded_io::Read for Cable {
    fn read(&mut self, room: &mut [u8]) -> Result<usize, Infallible> {
        while !self.inward.wait() {}
        Ok(self.inward.take(room))
    }
}

impl embedded_io::Write for Cable {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        self.outward.put(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}
