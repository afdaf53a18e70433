//! Who answers questions: somebody's log, or a teacher that looks at the true rewards and may be as bad a teacher as people can
//! be.

mod config;
mod replay;
mod scripted;

pub use config::{Says, TeacherConfig};
pub use replay::ReplayTeacher;
pub use scripted::ScriptedTeacher;

use super::{Answer, PreferenceError, Question};
use crate::dataset::Dataset;

/// Someone or something that answers questions.
pub trait Teacher {
    /// Who was asked last, as the log will say, such as `teacher:true-return`.
    fn name(&self) -> &str;

    /// Whether whoever gave no answer last only put the question off.
    fn put_off(&self) -> bool {
        false
    }

    /// The answer to the question of this number in the run, counted from 1; none if they cannot tell.
    fn answer(
        &mut self,
        dataset: &Dataset,
        number: usize,
        question: &Question,
    ) -> Result<Option<Answer>, PreferenceError>;
}
