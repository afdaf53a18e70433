//! The checks between a plant and a policy, each a small piece the controller composes.
//!
//! Nothing here allocates, panics or reads a clock: time is an argument.

mod action;
mod deadline;
mod fault;
mod observation;

pub use action::{Action, ActionGuard, Sent};
pub use deadline::{DEADLINE_LIMIT, Deadline};
pub use fault::Fault;
pub use observation::{ObservationFrame, ObservationGuard};
