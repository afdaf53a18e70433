//! Checkpoints written beside the training: the learner goes on while the disk is waited for.

use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::{Scope, ScopedJoinHandle};

use firmware_sim::disk::WriteError;

use crate::checkpoint::Checkpoint;

use super::{Clock, MetricsLog, RunFolder};

/// A thread that saves checkpoints in a run's folder, one at a time and in order. It ends when this is finished or dropped,
/// with what it has begun.
#[derive(Debug)]
pub struct Saver<'s> {
    queue: SyncSender<Checkpoint>,
    thread: ScopedJoinHandle<'s, Result<(), WriteError>>,
}

impl<'s> Saver<'s> {
    /// Starts it. What is in `metrics` when a checkpoint is handed over is on the disk before the checkpoint is, and what
    /// `clock` shows after it.
    ///
    /// # Errors
    /// When the file of the metrics cannot be opened a second time.
    pub fn start<'e>(
        scope: &'s Scope<'s, 'e>,
        folder: &'e RunFolder,
        metrics: &MetricsLog,
        clock: Clock,
    ) -> Result<Self, WriteError> {
        let metrics = metrics.again()?;
        // No room: handing over waits until the checkpoint before is written, so two at most are in memory.
        let (queue, checkpoints) = sync_channel::<Checkpoint>(0);
        let thread = scope.spawn(move || {
            checkpoints.into_iter().try_for_each(|checkpoint| {
                metrics.sync()?;
                folder.save(&checkpoint)?;
                clock.spent().write(folder)
            })
        });
        Ok(Self { queue, thread })
    }

    /// Hands a checkpoint over.
    ///
    /// # Errors
    /// When one before it could not be written.
    pub fn save(self, checkpoint: Checkpoint) -> Result<Self, WriteError> {
        if self.queue.send(checkpoint).is_ok() {
            return Ok(self);
        }
        self.finish()?;
        unreachable!("nothing but an error ends the thread before its queue")
    }

    /// Waits until all of them are on the disk.
    ///
    /// # Errors
    /// When one could not be written.
    pub fn finish(self) -> Result<(), WriteError> {
        drop(self.queue);
        // A panic there is a mistake of ours and goes on here.
        let joined = self.thread.join();
        joined.unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}
