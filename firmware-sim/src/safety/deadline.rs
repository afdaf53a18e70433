//! Whether the control loop keeps its period.
//!
//! A single late tick is counted and forgiven; [`DEADLINE_LIMIT`] in a row mean that the loop cannot keep up.

use super::Fault;

/// Late ticks in a row that latch a fault.
pub const DEADLINE_LIMIT: u8 = 3;

/// The share of the period, as a divisor, that a tick may be late: a fifth.
const TOLERANCE_DIVISOR: u32 = 5;

/// Watches the time between ticks.
#[derive(Clone, Copy, Debug)]
pub struct Deadline {
    limit_us: u64,
    last_us: Option<u64>,
    late_in_a_row: u8,
    missed: u32,
}

impl Deadline {
    /// A watch for ticks of this period.
    #[must_use]
    pub const fn new(period_us: u32) -> Self {
        let limit_us = period_us as u64 + (period_us / TOLERANCE_DIVISOR) as u64;
        Self {
            limit_us,
            last_us: None,
            late_in_a_row: 0,
            missed: 0,
        }
    }

    /// Notes a tick at `now_us` and counts it when it is late.
    ///
    /// # Errors
    /// When the clock went backwards, or this was the last of [`DEADLINE_LIMIT`] late ticks in a row.
    pub fn tick(&mut self, now_us: u64) -> Result<(), Fault> {
        let Some(last_us) = self.last_us.replace(now_us) else {
            return Ok(());
        };
        let Some(elapsed_us) = now_us.checked_sub(last_us) else {
            return Err(Fault::ClockWentBack { last_us, now_us });
        };
        if elapsed_us <= self.limit_us {
            self.late_in_a_row = 0;
            return Ok(());
        }
        self.missed = self.missed.saturating_add(1);
        self.late_in_a_row = self.late_in_a_row.saturating_add(1);
        if self.late_in_a_row >= DEADLINE_LIMIT {
            return Err(Fault::DeadlineMissed { elapsed_us });
        }
        Ok(())
    }

    /// Late ticks since the start of the episode.
    #[must_use]
    pub const fn missed(&self) -> u32 {
        self.missed
    }

    /// Forgets the previous tick and the run of late ones, not their count.
    pub fn rearm(&mut self) {
        self.last_us = None;
        self.late_in_a_row = 0;
    }

    /// Forgets everything, as before the first tick of an episode.
    pub fn reset(&mut self) {
        self.rearm();
        self.missed = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tick_within_a_fifth_of_the_period_is_on_time() {
        let mut deadline = Deadline::new(10_000);
        for now_us in [0, 12_000] {
            assert_eq!(deadline.tick(now_us), Ok(()));
        }
        assert_eq!(deadline.missed(), 0);
        assert_eq!(deadline.tick(24_001), Ok(()));
        assert_eq!(deadline.missed(), 1);
    }

    #[test]
    fn late_ticks_are_forgiven_until_three_come_in_a_row() {
        let mut deadline = Deadline::new(10_000);
        let ticks = [0, 20_000, 40_000, 50_000, 70_000, 90_000];
        for now_us in ticks {
            assert!(deadline.tick(now_us).is_ok());
        }
        assert_eq!(
            deadline.tick(110_000),
            Err(Fault::DeadlineMissed { elapsed_us: 20_000 })
        );
        assert_eq!(deadline.missed(), 5);
    }

    #[test]
    fn a_clock_that_goes_back_is_a_fault() {
        let mut deadline = Deadline::new(10_000);
        assert_eq!(deadline.tick(5), Ok(()));
        assert_eq!(
            deadline.tick(4),
            Err(Fault::ClockWentBack {
                last_us: 5,
                now_us: 4
            })
        );
    }

    #[test]
    fn rearming_forgives_the_pause_before_it() {
        let mut deadline = Deadline::new(10_000);
        assert_eq!(deadline.tick(0), Ok(()));
        deadline.rearm();
        assert_eq!(deadline.tick(1_000_000), Ok(()));
        assert_eq!(deadline.missed(), 0);
    }
}
