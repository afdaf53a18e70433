//! What a board brings along, beside a link with the traits of `embedded-io`: a clock, a counter, and a flash.

use embedded_storage::nor_flash::NorFlash;

/// The parts of a board that are neither link nor flash.
pub trait Board {
    /// What the board is called in the greeting, such as `mps2-an386`: at most [`NAME_LENGTH`](super::frame::NAME_LENGTH)
    /// bytes, or it does not compile.
    const NAME: &'static str;

    /// Ticks of [`Self::work`] in a second; 0 if that is not known.
    const WORK_HZ: u32;

    /// A clock that never goes back, in microseconds since whenever. It measures the silence of the link, nothing else.
    fn now_us(&mut self) -> u64;

    /// A counter that runs freely and wraps: the difference of two readings is what went by between them.
    fn work(&mut self) -> u32;

    /// Whether the link's `read_ready` can say that there is nothing. Where it cannot, as reading waits, nobody looks at the
    /// clock meanwhile, and an episode that is to be watched for silence is refused.
    fn notices_silence(&self) -> bool;

    /// The most stack that was ever in use, in bytes; 0 if that is not known.
    fn stack_high_water(&mut self) -> u32;

    /// There is nothing to read. Sleeps until something may have come, or returns at once; in no case for longer than
    /// a silent link may go unnoticed.
    fn idle(&mut self);
}

/// Flash that can be read in place, all of it at one address.
///
/// Offsets of the `NorFlash` methods count from the start of [`Self::bytes`]. `ERASE_SIZE` is the largest sector in use, and
/// a multiple of 16; `WRITE_SIZE` is at most 32.
pub trait MappedFlash: NorFlash {
    /// The whole flash, at an address that is a multiple of 16.
    fn bytes(&self) -> &[u8];
}
