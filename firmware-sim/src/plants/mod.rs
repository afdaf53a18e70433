//! What can be flown: Meta-World, a toy that needs no Python, a recording, and wrappers that record or lie.

pub mod fault;
pub mod metaworld;
pub mod recorder;
pub mod recording;
pub mod replay;
pub mod toy;
