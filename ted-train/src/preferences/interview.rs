//! Asking: somebody who answers, and the log that asks nobody twice.

use rand::Rng;

use super::{
    Context, LabelledPair, LogEntry, PreferenceError, PreferenceLog, Query, QueryStrategy,
    Question, Teacher,
};
use crate::dataset::{Dataset, SegmentSampler};

/// Somebody who is asked about a dataset, every answer going into a log before it is used.
pub struct Interview<'a> {
    dataset: &'a Dataset,
    teacher: &'a mut dyn Teacher,
    log: PreferenceLog,
}

/// Questions without an answer that are allowed for each answer.
const UNTOLD: usize = 10;

impl<'a> Interview<'a> {
    /// Begins it, or goes on with the one in the log, which must be about this dataset.
    pub fn new(dataset: &'a Dataset, teacher: &'a mut dyn Teacher, log: PreferenceLog) -> Self {
        Self {
            dataset,
            teacher,
            log,
        }
    }

    /// Asks about pairs that the strategy chooses until one of them is answered, and returns that one with its answer. A pair
    /// that nobody can tell apart spends none of the answers that are wanted.
    ///
    /// # Errors
    /// When the log holds another question in this place, an answer cannot be had or kept, or there is none after ten questions
    /// for each answer.
    pub fn ask(
        &mut self,
        context: Context,
        strategy: &dyn QueryStrategy,
        sampler: &SegmentSampler,
        rng: &mut dyn Rng,
    ) -> Result<LabelledPair, PreferenceError> {
        let allowed = UNTOLD * (self.log.answered() + 1);
        while self.log.untold().count() < allowed {
            let Some(segments) = strategy.choose(sampler, self.log.untold(), rng) else {
                break;
            };
            let query = Query { segments };
            let question = Question {
                context,
                query,
                why: strategy.why(segments),
            };
            if let Some(answer) = self.log.ask(self.dataset, self.teacher, question)? {
                return Ok(LabelledPair::new(query, answer));
            }
        }
        Err(self.log.nobody_can_tell())
    }

    /// All questions so far with what was said, those of earlier runs included.
    #[must_use]
    pub fn entries(&self) -> &[LogEntry] {
        self.log.entries()
    }

    /// How many questions of this run were answered so far.
    #[must_use]
    pub fn answered(&self) -> usize {
        self.log.answered()
    }

    /// Digest of the log, as [`PreferenceLog::digest`] has it.
    ///
    /// # Errors
    /// When the log cannot be read.
    pub fn digest(&mut self) -> Result<String, PreferenceError> {
        self.log.digest()
    }
}
