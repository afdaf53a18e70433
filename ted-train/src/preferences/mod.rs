//! Preferences: which of two segments is better, who said so, and the file that remembers it.
//!
//! A [`QueryStrategy`] chooses a [`Query`], and a [`Teacher`] answers it, or cannot tell: then another one is chosen. The
//! [`PreferenceLog`] keeps every question that was asked with what was said, one JSON object
//! a line, and asks nobody twice: a run that starts again with the same log gets the same answers, and a teacher that replays a
//! log ([`ReplayTeacher`]) stands in for whoever gave them.

mod entry;
mod error;
mod interview;
mod log;
mod pair;
mod query;
mod strategy;
mod teacher;
mod untold;

pub use entry::{Context, LogEntry};
pub use error::PreferenceError;
pub use interview::Interview;
pub use log::{PreferenceLog, Recovered};
pub use pair::LabelledPair;
pub use query::{Answer, Query, Question};
pub use strategy::{QueryStrategy, RandomPair};
pub use teacher::{ReplayTeacher, Says, ScriptedTeacher, Teacher, TeacherConfig};
pub use untold::Untold;
