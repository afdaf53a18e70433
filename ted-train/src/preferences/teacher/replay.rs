//! A teacher that repeats what a file of answers says.

use std::path::{Path, PathBuf};

use super::Teacher;
use crate::dataset::Dataset;
use crate::preferences::account::{account, clips, in_words, times};
use crate::preferences::hearing::hear;
use crate::preferences::{
    AnswerFile, Line, LogEntry, Numbered, PreferenceError, Question, Said, Use,
};

/// Gives the answers of a file to questions about the same clips, so that a run can be repeated, or gone on with, from the file
/// alone. Whoever gave an answer first is who gave it: the log of a replayed run is equal to the original to the byte.
#[derive(Clone, Debug)]
pub struct ReplayTeacher {
    path: PathBuf,
    lines: Vec<Numbered>,
}

impl ReplayTeacher {
    /// Reads the file at `path`, every line of which must be about `dataset`.
    ///
    /// # Errors
    /// When it cannot be read, or a line is no preference or does not fit.
    pub fn open(path: impl AsRef<Path>, dataset: &Dataset) -> Result<Self, PreferenceError> {
        let path = path.as_ref().to_path_buf();
        let lines = AnswerFile::read(&path)?.whole()?;
        for Numbered { number, line } in &lines {
            line.entry(dataset)
                .map_err(|misfit| PreferenceError::Misfit {
                    path: path.clone(),
                    line: *number,
                    misfit,
                })?;
        }
        Ok(Self { path, lines })
    }

    /// What it goes by.
    #[must_use]
    pub fn lines(&self) -> &[Numbered] {
        &self.lines
    }

    /// What became of every line in a run that has asked these questions.
    #[must_use]
    pub fn account(&self, asked: &[LogEntry]) -> Vec<Use> {
        account(&self.lines, asked)
    }

    /// The number, counted from 1, of the first of these answers that it would not have given; none when a run that
    /// holds them could be one that asked it.
    #[must_use]
    pub fn first_other_answer(&self, held: &[LogEntry]) -> Option<usize> {
        let others = (0..held.len()).find(|&index| {
            let LogEntry { question, said } = &held[index];
            let own = self.said_to(question, &held[..index]);
            own.is_none_or(|own| (own.answer, own.later) != (said.answer, said.later))
        });
        others.map(|index| index + 1)
    }

    /// What the file says to a question that comes after these; none when it says nothing.
    #[must_use]
    pub fn said_to(&self, question: &Question, asked: &[LogEntry]) -> Option<Said> {
        let before = times(asked, &question.query);
        hear(&self.lines, clips(&question.query), before).map(|heard| heard.said)
    }
}

impl Teacher for ReplayTeacher {
    fn answer(
        &mut self,
        dataset: &Dataset,
        asked: &[LogEntry],
        question: &Question,
    ) -> Result<Said, PreferenceError> {
        if let Some(said) = self.said_to(question, asked) {
            return Ok(said);
        }
        let wanted = LogEntry {
            question: question.clone(),
            said: Said {
                answer: None,
                later: false,
                by: "me".to_owned(),
                at: None,
            },
        };
        Err(PreferenceError::NotAnswered {
            path: self.path.clone(),
            number: asked.len() + 1,
            account: in_words(&self.account(asked)),
            line: Line::new(dataset, &wanted).text(),
        })
    }
}
