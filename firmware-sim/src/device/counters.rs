//! What went wrong on the link, counted on the device.

use serde::{Deserialize, Serialize};

/// Frames that were not acted on, by reason. Counts stop at their largest value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Frames with a wrong checksum, or that are no frames at all.
    pub crc_errors: u32,
    /// Frames longer than the longest.
    pub too_long: u32,
    /// Frames that arrived whole and hold no message of this protocol.
    pub malformed: u32,
    /// Requests that came again; each was answered again and not acted on.
    pub duplicates: u32,
    /// Requests older than the last one, dropped.
    pub reordered: u32,
    /// Requests that never came, by the gaps in their numbers.
    pub dropped: u32,
    /// Errors of the link's driver, such as an overrun where the driver reports one; and replies that fit no frame.
    pub link_errors: u32,
}

/// One more, up to the largest value.
#[inline(never)]
pub(crate) fn count(counter: &mut u32) {
    *counter = counter.saturating_add(1);
}
