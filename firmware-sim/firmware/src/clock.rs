//! The time since start-up: the rounds of SysTick, counted.

use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{SCB, SYST};
use cortex_m_rt::exception;

use crate::map::MAP;

/// Processor clocks in one round of SysTick: 4 or 5 ms, which is the longest sleep. It is 24 bits wide.
const ROUND: u32 = 100_000;
const RELOAD: u32 = ROUND - 1;
const TICKS_PER_US: u32 = MAP.clock_hz / 1_000_000;

/// The rounds, and how often their number went back to zero, which takes half a year. No core here writes 64 bits at once.
static ROUNDS: AtomicU32 = AtomicU32::new(0);
static ERAS: AtomicU32 = AtomicU32::new(0);

#[exception]
fn SysTick() {
    // Whoever reads is interrupted by this, never the other way round.
    let rounds = ROUNDS.load(Ordering::Relaxed).wrapping_add(1);
    ROUNDS.store(rounds, Ordering::Relaxed);
    if rounds == 0 {
        ERAS.store(ERAS.load(Ordering::Relaxed).wrapping_add(1), Ordering::Relaxed);
    }
}

/// A clock that runs.
pub struct Clock(());

impl Clock {
    /// Starts it at zero.
    pub fn start(mut timer: SYST) -> Self {
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(RELOAD);
        timer.clear_current();
        timer.enable_interrupt();
        timer.enable_counter();
        Self(())
    }

    /// Processor clocks since the start, round the end of `u32`.
    pub fn ticks(&self) -> u32 {
        let (rounds, within) = Self::read();
        (rounds as u32).wrapping_mul(ROUND).wrapping_add(within)
    }

    /// Microseconds since the start.
    pub fn now_us(&self) -> u64 {
        let (rounds, within) = Self::read();
        rounds * u64::from(ROUND / TICKS_PER_US) + u64::from(within / TICKS_PER_US)
    }

    /// Rounds since the start, and processor clocks since the last one.
    fn read() -> (u64, u32) {
        loop {
            let rounds = ROUNDS.load(Ordering::Relaxed);
            let eras = ERAS.load(Ordering::Relaxed);
            let ended = SCB::is_pendst_pending();
            let within = RELOAD - SYST::get_current();
            // A round that ends between these readings would count twice, or not at all.
            if rounds == ROUNDS.load(Ordering::Relaxed) && ended == SCB::is_pendst_pending() {
                let rounds = u64::from(eras) << 32 | u64::from(rounds);
                return (rounds.wrapping_add(u64::from(ended)), within);
            }
        }
    }
}
