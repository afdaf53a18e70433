//! Preferences: which of two segments is better, who said so, and the file that remembers it.
//!
//! A [`QueryStrategy`] chooses a [`Query`], and a [`Teacher`] answers it. The [`PreferenceLog`] keeps every question that was asked with its answer, one JSON object
//! a line, and asks nobody twice: a run that starts again with the same log gets the same answers, and a teacher that replays a
//! log ([`ReplayTeacher`]) stands in for whoever gave them.

mod entry;
mod error;
mod interview;
mod log;
mod pair;
mod query;
mod replay;
mod strategy;
mod teacher;

pub use entry::{Context, LogEntry};
pub use error::PreferenceError;
pub use interview::Interview;
pub use log::{PreferenceLog, Recovered};
pub use pair::LabelledPair;
pub use query::{Answer, Query};
pub use replay::ReplayTeacher;
pub use strategy::{QueryStrategy, RandomPair};
pub use teacher::{ScriptedTeacher, Teacher};
