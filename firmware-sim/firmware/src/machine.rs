//! The board as `firmware_sim::device` sees it.

use cortex_m::peripheral::SYST;
use firmware_sim::device::Board;

use crate::clock::Clock;
use crate::link::Link;
use crate::map::MAP;
use crate::stack;
use crate::uart::Uart;

/// A board with its clock running.
pub struct Machine {
    clock: Clock,
    sleeps: bool,
}

impl Machine {
    /// Starts the clock. The processor sleeps between bytes where the link has an interrupt to wake it.
    pub fn start(timer: SYST, link: &Link) -> Self {
        Self {
            clock: Clock::start(timer),
            sleeps: matches!(link, Link::Uart(_)),
        }
    }
}

impl Board for Machine {
    const NAME: &'static str = MAP.name;
    const WORK_HZ: u32 = MAP.clock_hz;

    fn now_us(&mut self) -> u64 {
        self.clock.now_us()
    }

    fn work(&mut self) -> u32 {
        let ticks = self.clock.ticks();
        if cfg!(feature = "panic-on-purpose") {
            assert!(ticks != 1, "on purpose");
        }
        ticks
    }

    /// The host's files do not: reading waits inside the host.
    fn notices_silence(&self) -> bool {
        self.sleeps
    }

    fn stack_high_water(&mut self) -> u32 {
        stack::high_water()
    }

    fn idle(&mut self) {
        if self.sleeps {
            Uart::sleep();
        }
    }
}
