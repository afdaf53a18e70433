//! One episode: observe, tick, apply, until the plant says it is over.

use std::time::Instant;

use thiserror::Error;

use super::{Pilot, TickTimes};
use crate::exit::ExitCode;
use crate::plant::{Plant, PlantError, StepOutcome};
use crate::remote::RemoteError;
use crate::safety::{Action, Fault, ObservationFrame};

/// What happened in an episode. A function of artefact, plant and seed: nothing in it depends on the machine that flew it.
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

/// Why an episode was not flown to its end.
#[derive(Debug, Error)]
pub enum EpisodeError {
    /// The plant failed.
    #[error(transparent)]
    Plant(#[from] PlantError),
    /// The pilot failed, which a controller on this machine cannot.
    #[error(transparent)]
    Pilot(#[from] RemoteError),
}

impl EpisodeError {
    /// How a command ends that fails with this error.
    #[must_use]
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::Plant(source) => source.exit_code(),
            Self::Pilot(source) => source.exit_code(),
        }
    }
}

/// Flies the episode of this seed to its end. A latched fault does not end it: the safe action goes out until then.
///
/// # Errors
/// When the plant or the pilot fails.
pub fn fly_episode(
    pilot: &mut impl Pilot,
    plant: &mut impl Plant,
    seed: u64,
) -> Result<(EpisodeReport, TickTimes), EpisodeError> {
    let mut underway = Underway::take_off(pilot, plant, seed)?;
    loop {
        let action = underway.decide(pilot, plant)?;
        if underway.settle(plant.apply(&action)?) {
            return Ok(underway.land());
        }
    }
}

/// An episode between its start and its end.
#[derive(Debug)]
pub(super) struct Underway {
    report: EpisodeReport,
    times: TickTimes,
}

impl Underway {
    /// Starts the episode of this seed.
    pub(super) fn take_off(
        pilot: &mut impl Pilot,
        plant: &mut impl Plant,
        seed: u64,
    ) -> Result<Self, EpisodeError> {
        pilot.reset()?;
        plant.reset(seed)?;
        Ok(Self {
            report: EpisodeReport {
                seed,
                return_true: 0.0,
                success: false,
                ticks: 0,
                fault: None,
                clamped_ticks: 0,
                slew_limited_ticks: 0,
                deadlines_missed: 0,
            },
            times: TickTimes::default(),
        })
    }

    /// What the pilot does about what the plant shows.
    pub(super) fn decide(
        &mut self,
        pilot: &mut impl Pilot,
        plant: &mut impl Plant,
    ) -> Result<Action, EpisodeError> {
        let observed = plant.observe()?;
        let now_us = plant.now_us();
        let (sequence, stamp_us) = (observed.sequence, observed.stamp_us);
        let frame = ObservationFrame {
            sequence,
            stamp_us,
            values: &observed.values,
        };
        let before = Instant::now();
        let (action, status) = pilot.tick(now_us, &frame)?;
        self.times.push(before.elapsed());

        let report = &mut self.report;
        report.clamped_ticks += u32::from(status.clamped);
        report.slew_limited_ticks += u32::from(status.slew_limited);
        report.deadlines_missed = status.deadlines_missed;
        if report.fault.is_none() {
            report.fault = status.fault.map(|fault| Latched {
                tick: status.tick,
                fault,
            });
        }
        Ok(action)
    }

    /// Notes what came of it, and says whether that was the end.
    pub(super) fn settle(&mut self, outcome: StepOutcome) -> bool {
        self.report.ticks += 1;
        self.report.return_true += outcome.reward_true;
        self.report.success |= outcome.success;
        outcome.done
    }

    pub(super) fn land(self) -> (EpisodeReport, TickTimes) {
        (self.report, self.times)
    }
}
