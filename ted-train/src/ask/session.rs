//! From the first question of a run to the last, and back as often as somebody wants.

use firmware_sim::progress::Audience;

use super::listener::{Listener, Wish};
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
    /// What decides the questions.
    pub config: &'a Config,
    /// Where the log is.
    pub folder: &'a RunFolder,
    /// Who answers, as every line of the log will say.
    pub by: &'a str,
    /// Who is told what happens.
    pub audience: Audience,
}

impl Session<'_> {
    /// Asks until the person says that these are the answers. Returns how many there are.
    ///
    /// # Errors
    /// When something was learned from the answers before, an answer cannot be kept, or the person stops.
    pub fn hold(&self, person: &mut dyn Person) -> Result<usize, AskError> {
        if has_learned(self.folder) {
            let folder = self.folder.path().to_path_buf();
            return Err(AskError::Learned { folder });
        }
        let ask = questions(self.dataset, self.config, self.audience)?;
        let path = self.folder.file(PREFERENCES);
        loop {
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
                of: self.config.answers(),
                by: self.by,
                wish: None,
            };
            let mut interview = Interview::new(self.dataset, &mut listener, log);
            let asked = ask(&mut interview);
            let wish = listener.wish;
            let stuck = match asked {
                Ok(()) => None,
                Err(LearnError::Preference(error @ PreferenceError::NobodyCanTell { .. })) => {
                    Some(error.to_string())
                }
                Err(LearnError::Preference(PreferenceError::LeftOpen)) => {
                    match wish {
                        Some(Wish::Reopen(place)) => self.reopen(place)?,
                        _ => return Err(AskError::Stopped),
                    }
                    continue;
                }
                Err(error) => return Err(error.into()),
            };
            let said = PreferenceLog::read(&path, self.dataset)?;
            let review = Review {
                said: &said,
                stuck: stuck.as_deref(),
            };
            match person.review(review) {
                Verdict::Reopen(place) => self.reopen(place)?,
                Verdict::Done if stuck.is_none() => {
                    return Ok(said
                        .iter()
                        .filter(|entry| entry.said.answer.is_some())
                        .count());
                }
                Verdict::Done | Verdict::Stop => return Err(AskError::Stopped),
            }
        }
    }

    /// Takes the answer of this place back, and with it those that depend on it.
    fn reopen(&self, place: usize) -> Result<(), AskError> {
        aside::reopen(self.folder, self.dataset, place)
    }
}
