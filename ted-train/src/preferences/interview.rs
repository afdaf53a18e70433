//! Asking: somebody who answers, and the log that asks nobody twice.

use super::{Context, LabelledPair, LogEntry, PreferenceError, PreferenceLog, Query, Teacher};
use crate::dataset::{Dataset, Segment};

/// Somebody who is asked about a dataset, every answer going into a log before it is used.
pub struct Interview<'a> {
    dataset: &'a Dataset,
    teacher: &'a mut dyn Teacher,
    log: PreferenceLog,
}

impl<'a> Interview<'a> {
    /// Begins it, or goes on with the one in the log, which must be about this dataset.
    pub fn new(dataset: &'a Dataset, teacher: &'a mut dyn Teacher, log: PreferenceLog) -> Self {
        Self {
            dataset,
            teacher,
            log,
        }
    }

    /// Asks about a pair of segments, and returns it with its answer.
    ///
    /// # Errors
    /// When the log holds another question in this place, or the answer cannot be had or kept.
    pub fn ask(
        &mut self,
        context: Context,
        segments: [Segment; 2],
    ) -> Result<LabelledPair, PreferenceError> {
        let query = Query { segments };
        let answer = self.log.ask(self.dataset, self.teacher, context, query)?;
        Ok(LabelledPair::new(query, answer))
    }

    /// All answers so far, those of earlier runs included.
    #[must_use]
    pub fn entries(&self) -> &[LogEntry] {
        self.log.entries()
    }

    /// Digest of the log, as [`PreferenceLog::digest`] has it.
    ///
    /// # Errors
    /// When the log cannot be read.
    pub fn digest(&mut self) -> Result<String, PreferenceError> {
        self.log.digest()
    }
}
