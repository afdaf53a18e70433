//! The teacher that waits for a person.

use std::path::Path;

use super::aside::Aside;
use super::person::{Person, Reply, Turn};
use crate::dataset::Dataset;
use crate::preferences::{Answer, PreferenceError, PreferenceLog, Question, Teacher};

/// Why an interview was broken off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wish {
    /// The question of this place in the log is to be asked again.
    Reopen(usize),
    /// No more for now.
    Stop,
}

/// Hands questions to a person, but for those that were answered before an earlier answer was changed.
pub(super) struct Listener<'p> {
    pub person: &'p mut dyn Person,
    pub log: &'p Path,
    pub aside: Aside,
    pub of: usize,
    pub by: &'p str,
    /// Who said what is to be written next, where that was somebody else.
    pub heard: Option<Heard>,
    pub wish: Option<Wish>,
}

/// What goes with the last answer into the log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Heard {
    pub by: String,
    pub later: bool,
}

impl Teacher for Listener<'_> {
    fn name(&self) -> &str {
        self.heard.as_ref().map_or(self.by, |heard| &heard.by)
    }

    fn put_off(&self) -> bool {
        self.heard.as_ref().is_some_and(|heard| heard.later)
    }

    fn answer(
        &mut self,
        dataset: &Dataset,
        _: usize,
        question: &Question,
    ) -> Result<Option<Answer>, PreferenceError> {
        if let Some(entry) = self.aside.said_to(&question.query) {
            self.heard = Some(Heard {
                by: entry.by.clone(),
                later: entry.later,
            });
            return Ok(entry.answer);
        }
        let before = PreferenceLog::read(self.log, dataset)?;
        let answered = before.iter().filter(|entry| entry.answer.is_some()).count();
        let reply = self.person.answer(Turn {
            question,
            number: answered + 1,
            of: self.of,
            before: &before,
        });
        let (answer, later) = match reply {
            Reply::Answer(answer) => (Some(answer), false),
            Reply::CannotTell => (None, false),
            Reply::Later => (None, true),
            Reply::Reopen(place) => {
                self.wish = Some(Wish::Reopen(place));
                return Err(PreferenceError::LeftOpen);
            }
            Reply::Stop => {
                self.wish = Some(Wish::Stop);
                return Err(PreferenceError::LeftOpen);
            }
        };
        self.heard = Some(Heard {
            by: self.by.to_owned(),
            later,
        });
        Ok(answer)
    }
}
