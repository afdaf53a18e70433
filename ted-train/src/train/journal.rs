//! What a run leaves on the disk while it learns: rows of metrics, the same as events, and checkpoints.

use std::thread::Scope;

use crate::algorithm::Metrics;
use crate::checkpoint::Checkpoint;
use crate::config::{Config, Schedule};
use crate::run::{Clock, EventWriter, MetricsLog, Phase, Saver};

use super::TrainError;
use super::prepared::Prepared;

/// The files that grow while one run learns.
pub(super) struct Journal<'s> {
    schedule: Schedule,
    phase: &'static str,
    steps: u64,
    digest: [u8; 32],
    metrics: MetricsLog,
    events: EventWriter,
    saver: Saver<'s>,
}

impl<'s> Journal<'s> {
    /// Goes on with the files of a run after the updates that it has saved.
    pub(super) fn begin<'e>(
        scope: &'s Scope<'s, 'e>,
        lane: &Prepared<'e>,
    ) -> Result<Self, TrainError> {
        let (folder, step) = (lane.folder, lane.step());
        let Config {
            schedule,
            algorithm,
            ..
        } = lane.config;
        let clock = Clock::start(folder, Phase::Policy);
        let metrics = MetricsLog::resume(&folder.file("metrics.jsonl"), step)?;
        Ok(Self {
            schedule: schedule.clone(),
            phase: algorithm.name(),
            steps: algorithm.steps(),
            digest: lane.config.digest(),
            // A resumed run starts another file.
            events: EventWriter::create(folder.path(), &format!("{step:010}"))?,
            saver: Saver::start(scope, folder, &metrics, clock)?,
            metrics,
        })
    }

    /// Whether there is anything to write after this update.
    pub(super) fn is_due(&self, step: u64) -> bool {
        self.row_is_due(step) || self.checkpoint_is_due(step)
    }

    /// Writes what is due after this update.
    ///
    /// # Errors
    /// When a number is not finite, or something before could not be written.
    pub(super) fn write(
        mut self,
        step: u64,
        row: &Metrics,
        checkpoint: impl FnOnce([u8; 32]) -> Checkpoint,
    ) -> Result<Self, TrainError> {
        if self.row_is_due(step) {
            finite(row, step)?;
            let row = self.metrics.push(self.phase, step, row)?;
            self.events.push(self.phase, step, &row)?;
        }
        if self.checkpoint_is_due(step) {
            self.saver = self.saver.save(checkpoint(self.digest))?;
        }
        Ok(self)
    }

    /// Saves a run that is to stop here, and says how it ended.
    pub(super) fn stop(
        self,
        step: u64,
        checkpoint: impl FnOnce([u8; 32]) -> Checkpoint,
    ) -> TrainError {
        let saved = self.saver.save(checkpoint(self.digest));
        match saved.and_then(Saver::finish) {
            Ok(()) => TrainError::Interrupted { step },
            Err(error) => error.into(),
        }
    }

    /// Waits until everything is on the disk.
    pub(super) fn finish(self) -> Result<(), TrainError> {
        Ok(self.saver.finish()?)
    }

    fn row_is_due(&self, step: u64) -> bool {
        step.is_multiple_of(self.schedule.log_every) || step == self.steps
    }

    fn checkpoint_is_due(&self, step: u64) -> bool {
        step.is_multiple_of(self.schedule.checkpoint_every) || step == self.steps
    }
}

/// Refuses to go on with a learner that has diverged. A loss says more than what followed from it.
fn finite(row: &Metrics, step: u64) -> Result<(), TrainError> {
    let diverged = row.iter().filter(|(_, number)| number.is_null());
    match diverged.min_by_key(|(metric, _)| !metric.ends_with("_loss")) {
        Some((metric, _)) => Err(TrainError::Diverged {
            metric: metric.replace('_', " "),
            step,
        }),
        None => Ok(()),
    }
}
