//! The link frame: a number, a message and a checksum, stuffed, and a zero at the end.
//!
//! ```text
//! frame = COBS(number: u16 LE | message: postcard | CRC-32 of both: u32 LE) | 00
//! ```

use serde::Serialize;
use ted_policy::crc32;

use super::cobs;
use super::encode::encode;

/// Bytes of an artefact in one [`Request::FlashData`](super::message::Request::FlashData), at most.
pub const CHUNK_LENGTH: usize = 512;

/// Bytes of a board's name, a firmware version or a task that a greeting carries, at most.
pub const NAME_LENGTH: usize = 48;

/// The longest message: a chunk of an artefact with its kind, its offset and its length.
pub const MAX_MESSAGE: usize = CHUNK_LENGTH + 8;

/// The longest message of a device: the answer to a tick with all actions, or a greeting with long names.
pub const MAX_REPLY: usize = 248;

pub(super) const NUMBER: usize = 2;
const CHECKSUM: usize = 4;

/// Bytes of a buffer in which every request can be built, or received with its final zero.
pub const MAX_FRAME: usize = framed(MAX_MESSAGE);

/// The same for replies.
pub const MAX_REPLY_FRAME: usize = framed(MAX_REPLY);

const fn framed(message: usize) -> usize {
    let body = NUMBER + message + CHECKSUM;
    cobs::room(body) + body + 1
}

/// What a frame holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Body<'a> {
    /// The number of the request, repeated by its reply.
    pub number: u16,
    /// The message, encoded.
    pub message: &'a [u8],
}

/// Builds the frame of a message at the start of `buffer` and returns its length, the final zero included; nothing when
/// the buffer is too short.
pub fn build(buffer: &mut [u8], number: u16, message: &impl Serialize) -> Option<usize> {
    // How much room the stuffing needs depends on the length, which is only known afterwards; so the most is left.
    let most = cobs::room(buffer.len());
    let body = buffer.get_mut(most..)?;
    let (head, rest) = body.split_first_chunk_mut::<NUMBER>()?;
    *head = number.to_le_bytes();
    let message_length = encode(message, rest)?;
    let checked = NUMBER + message_length;
    let checksum = crc32(&[body.get(..checked)?]).to_le_bytes();
    *body.get_mut(checked..)?.first_chunk_mut::<CHECKSUM>()? = checksum;

    let stuffed = cobs::stuff(buffer, most, checked + CHECKSUM)?;
    *buffer.get_mut(stuffed)? = 0;
    Some(stuffed + 1)
}

/// Takes a frame apart, in place and without its final zero; nothing when it is damaged.
pub fn open(stuffed: &mut [u8]) -> Option<Body<'_>> {
    let length = cobs::unstuff(stuffed)?;
    let (checked, checksum) = stuffed.get(..length)?.split_last_chunk::<CHECKSUM>()?;
    if crc32(&[checked]) != u32::from_le_bytes(*checksum) {
        return None;
    }
    let (number, message) = checked.split_first_chunk::<NUMBER>()?;
    Some(Body {
        number: u16::from_le_bytes(*number),
        message,
    })
}
