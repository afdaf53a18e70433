//! Preferences: which of two segments is better, who said so, and the file that remembers it.
//!
//! A [`QueryStrategy`] chooses a [`Query`], and a [`Teacher`] answers it, or cannot tell: then another one is chosen. The
//! [`PreferenceLog`] keeps every question that was asked with what was said, one JSON object
//! a line ([`Line`]), and asks nobody twice: a run that starts again with the same log gets the same answers. An [`AnswerFile`] is a
//! log that somebody hands over, and a teacher that replays it ([`ReplayTeacher`]) stands in for whoever gave the answers;
//! [`account`] says what became of its lines, and [`findings`] what is worth knowing of them beforehand.

mod account;
mod entry;
mod error;
mod file;
mod findings;
mod hearing;
mod interview;
mod line;
mod log;
mod pair;
mod query;
mod strategy;
mod teacher;
mod text;
mod untold;

pub use account::{Use, account, in_words};
pub use entry::{Context, LogEntry, Said};
pub use error::PreferenceError;
pub use file::{AnswerFile, Numbered};
pub use findings::{Finding, FindingKind, findings};
pub use interview::Interview;
pub use line::{Line, Misfit, Span};
pub use log::{PreferenceLog, Recovered};
pub use pair::LabelledPair;
pub use query::{Answer, Query, Question};
pub use strategy::{QueryStrategy, RandomPair};
pub use teacher::{ReplayTeacher, Says, ScriptedTeacher, Teacher, TeacherConfig};
pub use text::decode;
pub use untold::Untold;
