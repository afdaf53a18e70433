//! A person is asked: on a web page of this machine, or in a terminal.
//!
//! A [`Session`] puts the questions of a run to a [`Person`] and keeps what they say in the run's log. It is the learner that asks:
//! it chooses each question by the answers before it, waits in `Teacher::answer`, and the log has the answer on the disk before the
//! next question is chosen. Whoever takes an answer back ends the interview; the log is cut there and the interview begins again,
//! which gives the same questions as far as the answers are the same. What is computed before the first question is kept.
//!
//! ```text
//! learner (this thread)                       server (a thread of its own)
//!   Session --question--> Person = Page --scene--> Desk <--GET /api/scene-- browser
//!   log     <--answer---        <--word---------  Desk <--POST /api/say---
//! ```
//!
//! Neither end knows the other: a person at the terminal ([`Terminal`]) answers the same session. Whoever wants to know what the
//! answers did ([`Did`]) is told at any time: it is worked out from the log when somebody looks, and changes nothing.

mod aside;
mod channels;
mod clip;
mod did;
mod error;
pub mod film;
mod listener;
mod more;
mod person;
mod session;
mod terminal;
#[cfg(test)]
mod tests;
pub mod web;
mod words;

pub use channels::{Channels, Mark, Position};
pub use clip::{ClipSource, Numbers, Picture, Place, Track};
pub use did::{Did, Odd};
pub use error::AskError;
pub use more::begin;
pub use person::{Person, Reply, Review, Turn, Verdict};
pub use session::Session;
pub use terminal::Terminal;
