//! From the first question of a run to the last, and back as often as somebody wants.

use firmware_sim::progress::Audience;

use super::listener::{Listener, Wish};
use super::more::MORE;
use super::person::{Person, Review, Verdict};
use super::{AskError, aside};
use crate::config::Config;
use crate::dataset::Dataset;
use crate::preferences::{Interview, PreferenceError, PreferenceLog};
use crate::reward::LearnError;
use crate::run::{PREFERENCES, RunFolder};
use crate::train::{has_learned, questions};

/// A run whose questions a person answers.
pub struct Session<'a> {
    /// What is asked about.
    pub dataset: &'a Dataset,
    /// What decides the questions, and how many answers are wanted.
    pub config: &'a Config,
    /// How many were wanted before somebody wished for more.
    pub least: usize,
    /// Where the log is.
    pub folder: &'a RunFolder,
    /// Who answers, as every line of the log will say.
    pub by: &'a str,
    /// Who is told what happens.
    pub audience: Audience,
}

impl Session<'_> {
    /// Asks until the person says that these are the answers. Returns the configuration that wants as many, which is that of the folder.
    ///
    /// # Errors
    /// When something was learned from the answers before, an answer cannot be kept, or the person stops.
    pub fn hold(&self, person: &mut dyn Person) -> Result<Config, AskError> {
        if has_learned(self.folder) {
            let folder = self.folder.path().to_path_buf();
            return Err(AskError::Learned { folder });
        }
        let questions = questions(self.dataset, self.config, self.audience)?;
        let questions = questions.as_ref();
        let path = self.folder.file(PREFERENCES);
        let mut config = self.config.clone();
        loop {
            let wanted = config.answers();
            let log = PreferenceLog::open(&path, self.dataset)?;
            if let Some(recovered) = log.recovered() {
                self.audience.note(&format!(
                    "the preference log had a torn last line; {} answers are kept",
                    recovered.kept
                ));
            }
            let mut listener = Listener {
                person: &mut *person,
                aside: aside::open(self.folder, self.dataset)?,
                questions,
                of: wanted,
                least: self.least,
                by: self.by,
                wish: None,
            };
            let mut interview = Interview::new(self.dataset, &mut listener, log);
            let asked = questions.ask(&mut interview, wanted);
            let wish = listener.wish;
            let stuck = match asked {
                Ok(()) => None,
                Err(LearnError::Preference(error @ PreferenceError::NobodyCanTell { .. })) => {
                    Some(error.to_string())
                }
                Err(LearnError::Preference(PreferenceError::LeftOpen)) => {
                    match wish {
                        Some(Wish::Reopen(place)) => self.reopen(place)?,
                        Some(Wish::Answers(answers)) => config = self.wanting(answers)?,
                        Some(Wish::Stop) | None => return Err(AskError::Stopped),
                    }
                    continue;
                }
                Err(error) => return Err(error.into()),
            };
            let said = PreferenceLog::read(&path, self.dataset)?;
            let review = Review {
                said: &said,
                stuck: stuck.as_deref(),
                questions,
            };
            match person.review(review) {
                Verdict::Reopen(place) => self.reopen(place)?,
                Verdict::More if stuck.is_none() => config = self.wanting(wanted + MORE)?,
                Verdict::Done if stuck.is_none() => return Ok(config),
                Verdict::More | Verdict::Done | Verdict::Stop => return Err(AskError::Stopped),
            }
        }
    }

    /// Wants so many answers from now on, also after a kill.
    fn wanting(&self, answers: usize) -> Result<Config, AskError> {
        let config = self.config.asking(answers);
        self.folder.reconfigure(&config)?;
        Ok(config)
    }

    /// Takes the answer of this place back, and with it those that depend on it.
    fn reopen(&self, place: usize) -> Result<(), AskError> {
        aside::reopen(self.folder, self.dataset, place)
    }
}
