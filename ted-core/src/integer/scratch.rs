//! Working memory of an integer forward pass, owned by the caller.

use crate::limits::{MAX_INPUT, MAX_WIDTH};

/// Buffers for one forward pass at a time. Its contents never influence a result.
#[derive(Clone, Debug)]
pub struct IntegerScratch {
    pub(crate) input: [i16; MAX_INPUT],
    pub(crate) ping_pong: IntegerPingPong,
}

/// Two layer outputs: one is read while the other is written.
#[derive(Clone, Debug)]
pub(crate) struct IntegerPingPong {
    pub(super) ping: [i16; MAX_WIDTH],
    pub(super) pong: [i16; MAX_WIDTH],
}

impl IntegerScratch {
    /// Zeroed working memory; fit for a `static`.
    #[must_use]
    pub const fn new() -> Self {
        // One constant, which is filled in where it is used: made of parts, it would be on a device's stack twice.
        const {
            Self {
                input: [0; MAX_INPUT],
                ping_pong: IntegerPingPong {
                    ping: [0; MAX_WIDTH],
                    pong: [0; MAX_WIDTH],
                },
            }
        }
    }
}

impl Default for IntegerScratch {
    fn default() -> Self {
        Self::new()
    }
}
