//! Working memory of an integer forward pass, owned by the caller.

use crate::limits::MAX_WIDTH;

/// Two layer outputs: one is read while the other is written. Its contents never influence a result.
#[derive(Clone, Debug)]
pub struct IntegerScratch {
    pub(super) ping: [i16; MAX_WIDTH],
    pub(super) pong: [i16; MAX_WIDTH],
}

impl IntegerScratch {
    /// Zeroed working memory; fit for a `static`.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            ping: [0; MAX_WIDTH],
            pong: [0; MAX_WIDTH],
        }
    }
}

impl Default for IntegerScratch {
    fn default() -> Self {
        Self::new()
    }
}
