//! A teacher that repeats what a log says.

use super::Teacher;
use crate::dataset::Dataset;
use crate::preferences::entry::Line;
use crate::preferences::error::describe;
use crate::preferences::{Answer, LogEntry, PreferenceError, PreferenceLog, Question};
use std::path::Path;

/// Gives the answers of a log to the same questions in the same places, so that a run can be repeated, or gone on with, from
/// the file alone.
#[derive(Clone, Debug)]
pub struct ReplayTeacher {
    name: String,
    entries: Vec<LogEntry>,
    /// The question that was answered last, counted from 1.
    last: usize,
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
            last: 0,
        })
    }

    /// The number, counted from 1, of the first of these answers that it would not have given; none when a run that
    /// holds them could be one that asked it.
    #[must_use]
    pub fn first_other_answer(&self, held: &[LogEntry]) -> Option<usize> {
        let said = |entry: &LogEntry| (entry.question.query, entry.answer);
        let mut held = (1..).zip(held);
        let other = held.find(|(number, held)| {
            self.entry(*number)
                .is_none_or(|own| said(own) != said(held))
        });
        other.map(|(number, _)| number)
    }

    /// The line of this number, counted from 1.
    fn entry(&self, number: usize) -> Option<&LogEntry> {
        self.entries.get(number.checked_sub(1)?)
    }
}

impl Teacher for ReplayTeacher {
    fn name(&self) -> &str {
        // Whoever answered first is who answered: a replayed log is equal to the original to the byte.
        match self.entry(self.last) {
            Some(entry) => &entry.by,
            None => &self.name,
        }
    }

    fn put_off(&self) -> bool {
        self.entry(self.last).is_some_and(|entry| entry.later)
    }

    fn answer(
        &mut self,
        dataset: &Dataset,
        number: usize,
        question: &Question,
    ) -> Result<Option<Answer>, PreferenceError> {
        let Some(logged) = self.entry(number) else {
            let wanted = LogEntry {
                question: question.clone(),
                answer: None,
                later: false,
                by: "me".to_owned(),
            };
            return Err(PreferenceError::ReplayExhausted {
                answers: self.entries.len(),
                number,
                line: Line::new(dataset, &wanted).text(),
            });
        };
        if logged.question.query != question.query {
            return Err(PreferenceError::OtherQuestion {
                number,
                asked: describe(&question.query),
                logged: describe(&logged.question.query),
            });
        }
        let answer = logged.answer;
        self.last = number;
        Ok(answer)
    }
}
