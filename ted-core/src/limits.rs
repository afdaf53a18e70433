//! Compile-time limits: they size every buffer, so nothing is ever allocated.

/// Widest layer, counted in inputs or in outputs.
pub const MAX_WIDTH: usize = 256;

/// Most layers in one network.
pub const MAX_LAYERS: usize = 4;

/// Most members in one reward ensemble.
pub const MAX_MEMBERS: usize = 8;

/// Most channels in one observation.
pub const MAX_OBSERVATION: usize = 64;

/// Most channels in one action.
pub const MAX_ACTION: usize = 16;

/// Widest network input: a reward model may see the observation followed by the action.
pub(crate) const MAX_INPUT: usize = MAX_OBSERVATION + MAX_ACTION;

const _: () = assert!(MAX_INPUT <= MAX_WIDTH);
