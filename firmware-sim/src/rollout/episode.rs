//! One episode: observe, tick, apply, until the plant says it is over.

use std::time::Instant;

use super::TickTimes;
use crate::controller::Controller;
use crate::plant::{Plant, PlantError};
use crate::safety::{Fault, ObservationFrame};

/// What happened in an episode. A function of artefact, plant and seed: nothing in it depends on the machine.
#[derive(Clone, Debug, PartialEq)]
pub struct EpisodeReport {
    /// The episode's seed.
    pub seed: u64,
    /// The plant's rewards, summed in step order.
    pub return_true: f64,
    /// Whether the task counted as solved after any step.
    pub success: bool,
    /// Control periods flown.
    pub ticks: u32,
    /// The fault that was latched, if one was: from its tick on the safe action went out.
    pub fault: Option<Latched>,
    /// Ticks whose action was clamped into the contract's range.
    pub clamped_ticks: u32,
    /// Ticks whose action was held back by the slew limit.
    pub slew_limited_ticks: u32,
    /// Ticks that came late on the plant's clock.
    pub deadlines_missed: u32,
}

/// A fault and the tick it was latched at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Latched {
    /// Ticks since the start of the episode.
    pub tick: u32,
    /// The reason.
    pub fault: Fault,
}

/// Flies the episode of this seed to its end. A latched fault does not end it: the safe action goes out until then.
///
/// # Errors
/// When the plant fails.
pub fn fly_episode(
    controller: &mut Controller<'_>,
    plant: &mut impl Plant,
    seed: u64,
) -> Result<(EpisodeReport, TickTimes), PlantError> {
    let mut report = EpisodeReport {
        seed,
        return_true: 0.0,
        success: false,
        ticks: 0,
        fault: None,
        clamped_ticks: 0,
        slew_limited_ticks: 0,
        deadlines_missed: 0,
    };
    let mut times = TickTimes::default();
    controller.reset();
    plant.reset(seed)?;
    loop {
        let observed = plant.observe()?;
        let now_us = plant.now_us();
        let (sequence, stamp_us) = (observed.sequence, observed.stamp_us);
        let frame = ObservationFrame {
            sequence,
            stamp_us,
            values: &observed.values,
        };
        let before = Instant::now();
        let (action, status) = controller.tick(now_us, &frame);
        times.push(before.elapsed());

        let outcome = plant.apply(&action)?;
        report.ticks += 1;
        report.return_true += outcome.reward_true;
        report.success |= outcome.success;
        report.clamped_ticks += u32::from(status.clamped);
        report.slew_limited_ticks += u32::from(status.slew_limited);
        report.deadlines_missed = status.deadlines_missed;
        if report.fault.is_none() {
            report.fault = status.fault.map(|fault| Latched {
                tick: status.tick,
                fault,
            });
        }
        if outcome.done {
            return Ok((report, times));
        }
    }
}
