//! Who answers questions: somebody's log, or a teacher that looks at the true rewards and may be as bad a teacher as people can
//! be.

mod config;
mod replay;
mod scripted;

pub use config::{Says, TeacherConfig};
pub use replay::ReplayTeacher;
pub use scripted::ScriptedTeacher;

use super::{LogEntry, PreferenceError, Question, Said};
use crate::dataset::Dataset;

/// Someone or something that answers questions.
pub trait Teacher {
    /// What is said to a question that comes after those that the run has asked already.
    ///
    /// # Errors
    /// When nothing can be said, not even that they cannot tell.
    fn answer(
        &mut self,
        dataset: &Dataset,
        asked: &[LogEntry],
        question: &Question,
    ) -> Result<Said, PreferenceError>;
}
