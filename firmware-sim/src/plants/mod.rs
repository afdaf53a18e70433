//! Plants that need nothing but this crate: a toy, a recording, and a fault injector around any other.

pub mod fault;
pub mod replay;
pub mod toy;
