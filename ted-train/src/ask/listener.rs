//! The teacher that waits for a person.

use super::more::MORE;
use super::person::{Person, Reply, Turn};
use crate::dataset::Dataset;
use crate::preferences::{LogEntry, PreferenceError, Question, ReplayTeacher, Said, Teacher};
use crate::reward::Questions;

/// Why an interview was broken off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wish {
    /// The question of this place in the log is to be asked again.
    Reopen(usize),
    /// So many answers are wanted.
    Answers(usize),
    /// No more for now.
    Stop,
}

/// Hands questions to a person, but for those that were answered before an earlier answer was changed.
pub(super) struct Listener<'p> {
    pub person: &'p mut dyn Person,
    pub aside: Option<ReplayTeacher>,
    pub questions: &'p dyn Questions,
    pub of: usize,
    pub least: usize,
    pub by: &'p str,
    pub wish: Option<Wish>,
}

impl Listener<'_> {
    /// Breaks the interview off.
    fn leave(&mut self, wish: Wish) -> PreferenceError {
        self.wish = Some(wish);
        PreferenceError::LeftOpen
    }
}

impl Teacher for Listener<'_> {
    fn answer(
        &mut self,
        _: &Dataset,
        asked: &[LogEntry],
        question: &Question,
    ) -> Result<Said, PreferenceError> {
        let aside = self.aside.as_ref();
        if let Some(said) = aside.and_then(|it| it.said_to(question, asked)) {
            return Ok(said);
        }
        let answered = asked.iter().filter(|it| it.said.answer.is_some()).count();
        let reply = self.person.answer(Turn {
            question,
            number: answered + 1,
            of: self.of,
            least: self.least,
            before: asked,
            questions: self.questions,
        });
        let (answer, later) = match reply {
            Reply::Answer(answer) => (Some(answer), false),
            Reply::CannotTell => (None, false),
            Reply::Later => (None, true),
            Reply::Reopen(place) => return Err(self.leave(Wish::Reopen(place))),
            Reply::More => return Err(self.leave(Wish::Answers(self.of + MORE))),
            Reply::Enough => return Err(self.leave(Wish::Answers(answered.max(self.least)))),
            Reply::Stop => return Err(self.leave(Wish::Stop)),
        };
        Ok(Said {
            answer,
            later,
            by: self.by.to_owned(),
            at: None,
        })
    }
}
