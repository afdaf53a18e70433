//! The bridge to MuJoCo Meta-World: Python worker processes that simulate, driven in lockstep over their standard streams.
//!
//! [`environment::ensure`] sets up the Python side once, [`Worker`] is one process, [`Pool`] runs many episodes on several.
//! The bytes on the wire are described in `docs/bridge-protocol.md`.

mod engine;
pub mod environment;
mod episode;
mod error;
pub mod frame;
#[cfg(test)]
mod golden;
mod link;
pub mod message;
mod picture;
mod pool;
pub mod speed;
mod worker;

pub use crate::last_words::LastWords;
pub use engine::Engine;
pub use environment::Environment;
pub use episode::{Behaviour, Episode, EpisodeJob};
pub use error::BridgeError;
pub use message::{Move, Shape, Step};
pub use picture::{Look, PictureJob, Pictures, State};
pub use pool::Pool;
pub use worker::Worker;
