//! From a stream of bytes to frames, in one fixed buffer: whatever is no frame is counted and skipped.

use super::Counters;
use super::counters::count;
use super::frame::{self, Body, MAX_FRAME, NUMBER};

/// Collects bytes until a zero ends a frame.
///
/// The cycle is [`Self::room`], [`Self::received`], then [`Self::advance`] and [`Self::body`] until there is no frame left.
#[derive(Debug)]
pub struct Receiver<const N: usize = MAX_FRAME> {
    buffer: [u8; N],
    /// Bytes received.
    filled: usize,
    /// Bytes of the frame that was last handed out, its zero included.
    taken: usize,
    /// What the last whole frame held, and how many bytes of message; they lie behind the number.
    number: u16,
    message: usize,
    /// Whether everything up to the next zero belongs to a frame that was too long.
    skipping: bool,
}

impl<const N: usize> Receiver<N> {
    /// An empty one.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            buffer: [0; N],
            filled: 0,
            taken: 0,
            number: 0,
            message: 0,
            skipping: false,
        }
    }

    /// Where the next bytes go; never empty.
    pub fn room(&mut self, counters: &mut Counters) -> &mut [u8] {
        self.forget_taken();
        if self.filled >= N {
            // No zero in all of it: these bytes are no frame, or the start of one that is too long.
            self.filled = 0;
            if !self.skipping {
                count(&mut counters.too_long);
            }
            self.skipping = true;
        }
        self.buffer.get_mut(self.filled..).unwrap_or_default()
    }

    /// So many bytes were put there.
    pub fn received(&mut self, length: usize) {
        self.filled = self.filled.saturating_add(length).min(N);
    }

    /// Goes on to the next whole frame among the bytes received; false when there is none. Damaged ones on the way are
    /// counted; empty ones are not, as a sender may end with a zero of its own what a disturbance began.
    pub fn advance(&mut self, counters: &mut Counters) -> bool {
        loop {
            self.forget_taken();
            let received = self.buffer.get(..self.filled).unwrap_or_default();
            let Some(length) = received.iter().position(|byte| *byte == 0) else {
                return false;
            };
            self.taken = length + 1;
            if core::mem::take(&mut self.skipping) || length == 0 {
                continue;
            }
            match self.buffer.get_mut(..length).and_then(frame::open) {
                Some(body) => {
                    (self.number, self.message) = (body.number, body.message.len());
                    return true;
                }
                None => count(&mut counters.crc_errors),
            }
        }
    }

    /// The frame that [`Self::advance`] went to.
    #[must_use]
    pub fn body(&self) -> Body<'_> {
        Body {
            number: self.number,
            message: self
                .buffer
                .get(NUMBER..NUMBER + self.message)
                .unwrap_or_default(),
        }
    }

    /// Moves what came behind the last frame to the start.
    fn forget_taken(&mut self) {
        let left = self.filled.saturating_sub(self.taken);
        for to in 0..left {
            let Some(byte) = self.buffer.get(self.taken + to).copied() else {
                break;
            };
            if let Some(place) = self.buffer.get_mut(to) {
                *place = byte;
            }
        }
        (self.filled, self.taken) = (left, 0);
    }
}

impl<const N: usize> Default for Receiver<N> {
    fn default() -> Self {
        Self::new()
    }
}
