//! Whether an observation may be flown on: whole, finite, in range, fresh, and the one after the last.

use heapless::Vec;
use ted_core::MAX_OBSERVATION;
use ted_policy::ObservationChannel;

use super::Fault;

/// An observation as it reaches the controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObservationFrame<'a> {
    /// Rises by one with every frame, round the end of `u32`; the first may have any number.
    pub sequence: u32,
    /// When it was taken, on the clock the controller ticks by.
    pub stamp_us: u64,
    /// One value per channel of the contract, in its units.
    pub values: &'a [f32],
}

/// What the contract promises about observations, and the number of the last good one.
#[derive(Clone, Debug)]
pub struct ObservationGuard {
    ranges: Vec<(f32, f32), MAX_OBSERVATION>,
    max_age_us: u64,
    last_sequence: Option<u32>,
}

impl ObservationGuard {
    /// A guard for a contract's channels, before its first frame.
    #[must_use]
    pub fn new<'c>(
        channels: impl Iterator<Item = ObservationChannel<'c>>,
        max_observation_age_us: u32,
    ) -> Self {
        let mut ranges = Vec::new();
        for channel in channels {
            // There is room: a contract has no more.
            ranges.push((channel.low, channel.high)).ok();
        }
        Self {
            ranges,
            max_age_us: u64::from(max_observation_age_us),
            last_sequence: None,
        }
    }

    /// Accepts the frame, or says what is wrong with it. Content is judged before time, time before order.
    ///
    /// # Errors
    /// The first defect found.
    pub fn check(&mut self, now_us: u64, frame: &ObservationFrame<'_>) -> Result<(), Fault> {
        self.check_values(frame.values)?;
        self.check_age(now_us, frame.stamp_us)?;
        self.check_sequence(frame.sequence)
    }

    /// Accepts any sequence number next.
    pub fn rearm(&mut self) {
        self.last_sequence = None;
    }

    fn check_values(&self, values: &[f32]) -> Result<(), Fault> {
        if values.len() != self.ranges.len() {
            return Err(Fault::WrongLength {
                expected: self.ranges.len(),
                actual: values.len(),
            });
        }
        if let Some(index) = values.iter().position(|value| !value.is_finite()) {
            return Err(Fault::NotFinite { index });
        }
        let mut pairs = values.iter().zip(&self.ranges);
        match pairs.position(|(value, (low, high))| value < low || value > high) {
            Some(index) => Err(Fault::OutOfRange { index }),
            None => Ok(()),
        }
    }

    fn check_age(&self, now_us: u64, stamp_us: u64) -> Result<(), Fault> {
        match now_us.checked_sub(stamp_us) {
            Some(age_us) if age_us <= self.max_age_us => Ok(()),
            _ => Err(Fault::Stale { stamp_us, now_us }),
        }
    }

    fn check_sequence(&mut self, actual: u32) -> Result<(), Fault> {
        let last = self.last_sequence.replace(actual);
        match last.map(|last| last.wrapping_add(1)) {
            Some(expected) if expected != actual => Err(Fault::OutOfSequence { expected, actual }),
            _ => Ok(()),
        }
    }
}
