//! Working memory of a forward pass, owned by the caller so that parameters stay immutable and shareable.

use crate::error::{Part, ShapeError};
use crate::limits::{MAX_INPUT, MAX_WIDTH};

/// Buffers for one forward pass at a time. Its contents never influence a result.
#[derive(Clone, Debug)]
// Whole cache lines, each buffer: no register's load takes two.
#[cfg_attr(target_arch = "x86_64", repr(align(64)))]
pub struct Scratch {
    pub(crate) input: [f32; MAX_INPUT],
    pub(crate) ping_pong: PingPong,
}

/// Two layer outputs: one is read while the other is written.
#[derive(Clone, Debug)]
pub(crate) struct PingPong {
    pub(crate) ping: [f32; MAX_WIDTH],
    pub(crate) pong: [f32; MAX_WIDTH],
}

impl Scratch {
    /// Zeroed working memory; fit for a `static`.
    #[must_use]
    pub const fn new() -> Self {
        // One constant, which is filled in where it is used: made of parts, it would be on a device's stack twice.
        const {
            Self {
                input: [0.0; MAX_INPUT],
                ping_pong: PingPong {
                    ping: [0.0; MAX_WIDTH],
                    pong: [0.0; MAX_WIDTH],
                },
            }
        }
    }
}

impl Default for Scratch {
    fn default() -> Self {
        Self::new()
    }
}

/// The filled input buffer beside the buffers the network writes to.
pub(crate) struct Input<'s> {
    pub(crate) values: &'s mut [f32],
    pub(crate) ping_pong: &'s mut PingPong,
}

impl Scratch {
    /// Copies `parts`, one after the other, into the input buffer.
    pub(crate) fn take_input(&mut self, parts: &[&[f32]]) -> Result<Input<'_>, ShapeError> {
        let width = parts.iter().map(|part| part.len()).sum();
        let too_wide = ShapeError::TooLarge {
            part: Part::Input,
            limit: MAX_INPUT,
            actual: width,
        };
        let values = self.input.get_mut(..width).ok_or(too_wide)?;
        for (value, source) in values.iter_mut().zip(parts.iter().copied().flatten()) {
            *value = *source;
        }
        Ok(Input {
            values,
            ping_pong: &mut self.ping_pong,
        })
    }
}
