//! The board that this machine is.

use std::time::Instant;

use crate::device::Board;

/// This machine's clock; its work is counted in nanoseconds of it.
#[derive(Clone, Copy, Debug)]
pub struct HostBoard {
    started: Instant,
}

impl HostBoard {
    /// A board that starts now.
    #[must_use]
    pub fn new() -> Self {
        Self {
            started: Instant::now(),
        }
    }
}

impl Default for HostBoard {
    fn default() -> Self {
        Self::new()
    }
}

impl Board for HostBoard {
    const NAME: &'static str = "host";
    const WORK_HZ: u32 = 1_000_000_000;

    fn now_us(&mut self) -> u64 {
        self.started.elapsed().as_micros() as u64
    }

    fn work(&mut self) -> u32 {
        self.started.elapsed().as_nanos() as u32
    }

    fn notices_silence(&self) -> bool {
        true
    }

    fn stack_high_water(&mut self) -> u32 {
        0
    }

    /// Nothing: the cable waits.
    fn idle(&mut self) {}
}
