//! Preferences: which of two segments is better, who said so, and the file that remembers it.
//!
//! A [`Teacher`] answers a [`Query`]. The [`PreferenceLog`] keeps every question that was asked with its answer, one JSON object
//! a line, and asks nobody twice: a run that starts again with the same log gets the same answers, and a teacher that replays a
//! log ([`ReplayTeacher`]) stands in for whoever gave them.

mod entry;
mod error;
mod log;
mod query;
mod replay;
mod teacher;

pub use entry::{Context, LogEntry};
pub use error::PreferenceError;
pub use log::{PreferenceLog, Recovered};
pub use query::{Answer, Query};
pub use replay::ReplayTeacher;
pub use teacher::{ScriptedTeacher, Teacher};
