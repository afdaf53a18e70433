//! A teacher that repeats what a log says.

use super::error::describe;
use super::{Answer, LogEntry, PreferenceError, PreferenceLog, Query, Teacher};
use crate::dataset::Dataset;
use std::path::Path;

/// Gives the answers of a log to the same questions in the same order, so that a run can be repeated, or gone on with, from
/// the file alone.
#[derive(Clone, Debug)]
pub struct ReplayTeacher {
    name: String,
    entries: Vec<LogEntry>,
    asked: usize,
}

impl ReplayTeacher {
    /// Reads the log at `path`, which must be about `dataset`.
    pub fn open(path: impl AsRef<Path>, dataset: &Dataset) -> Result<Self, PreferenceError> {
        let path = path.as_ref();
        let entries = PreferenceLog::read(path, dataset)?;
        let file = path
            .file_name()
            .unwrap_or(path.as_os_str())
            .to_string_lossy();
        Ok(Self {
            name: format!("replay:{file}"),
            entries,
            asked: 0,
        })
    }

    /// The number, counted from 1, of the first of these answers that it would not have given; none when a run that
    /// holds them could be one that asked it.
    #[must_use]
    pub fn first_other_answer(&self, held: &[LogEntry]) -> Option<usize> {
        let mut rest = self.entries.iter();
        let mut given = |held: &LogEntry| {
            rest.any(|entry| (entry.query, entry.answer) == (held.query, held.answer))
        };
        held.iter()
            .position(|held| !given(held))
            .map(|index| index + 1)
    }
}

impl Teacher for ReplayTeacher {
    fn name(&self) -> &str {
        // Whoever answered first is who answered: a replayed log is equal to the original to the byte.
        match self
            .asked
            .checked_sub(1)
            .and_then(|last| self.entries.get(last))
        {
            Some(entry) => &entry.by,
            None => &self.name,
        }
    }

    fn answer(&mut self, _: &Dataset, query: &Query) -> Result<Answer, PreferenceError> {
        let number = self.asked + 1;
        let rest = &self.entries[self.asked..];
        let expected = rest.first().ok_or(PreferenceError::ReplayExhausted {
            answers: self.entries.len(),
            number,
        })?;
        // A run that goes on takes its first answers from its own log and asks here only for the later ones.
        let skipped = rest
            .iter()
            .position(|entry| entry.query == *query)
            .ok_or_else(|| PreferenceError::OtherQuestion {
                number,
                asked: describe(query),
                logged: describe(&expected.query),
            })?;
        self.asked += skipped + 1;
        Ok(rest[skipped].answer)
    }
}
