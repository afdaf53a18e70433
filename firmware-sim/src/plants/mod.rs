//! What can be flown: a task of a simulator process, a toy that needs no Python, a recording, and wrappers that record or lie.

pub mod fault;
pub mod recorder;
pub mod recording;
pub mod replay;
pub mod simulated;
pub mod toy;
