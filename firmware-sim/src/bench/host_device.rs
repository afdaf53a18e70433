//! A device that is a thread: the code of a device at the end of a cable.

use std::io;
use std::thread::{self, JoinHandle};

use super::{Cable, HostBoard, MemoryFlash, cable};
use crate::device::serve;

/// A running device, and the host's end of its cable.
///
/// Its thread ends when this is dropped, or with [`Self::power_off`].
#[derive(Debug)]
pub struct HostDevice {
    cable: Cable,
    thread: JoinHandle<MemoryFlash>,
}

impl HostDevice {
    /// Starts a device with this flash.
    #[must_use]
    pub fn power_on(mut flash: MemoryFlash) -> Self {
        let (cable, far_end) = cable();
        let thread = thread::spawn(move || {
            serve(far_end, &mut flash, &mut HostBoard::new());
            flash
        });
        Self { cable, thread }
    }

    /// Stops the device, and takes the flash out.
    ///
    /// # Panics
    /// When the device panicked, with its own words. That is what tests look for.
    #[must_use]
    pub fn power_off(self) -> MemoryFlash {
        drop(self.cable);
        match self.thread.join() {
            Ok(flash) => flash,
            Err(panic) => std::panic::resume_unwind(panic),
        }
    }
}

impl io::Read for HostDevice {
    fn read(&mut self, room: &mut [u8]) -> io::Result<usize> {
        self.cable.read(room)
    }
}

impl io::Write for HostDevice {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.cable.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.cable.flush()
    }
}
