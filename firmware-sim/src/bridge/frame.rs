//! The frame codec: a greeting that never changes, then frames with length, kind, sequence number and checksum.

use thiserror::Error;

/// The version of the protocol this program speaks. Raise it with every change of `docs/bridge-protocol.md`.
pub const PROTOCOL_VERSION: u32 = 5;

/// Bytes of the greeting, in every version of the protocol.
pub const HELLO_LEN: usize = 16;
/// Bytes before the payload of a frame.
pub const HEADER_LEN: usize = 16;
/// The longest payload either side accepts.
pub const MAX_PAYLOAD: usize = 64 * 1024 * 1024;

const MAGIC: [u8; 8] = *b"TEDBRDG\n";
/// The header bytes that the checksum covers, ahead of the payload.
const CHECKED: usize = 12;

/// Bytes that are no frame of this protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum FrameError {
    /// The greeting does not start with the magic, or its version is not backed by its complement.
    #[error("the greeting is not the bridge's")]
    NotAGreeting,
    /// A frame announces more than either side accepts.
    #[error("a frame announces {actual} bytes, the limit is {expected}")]
    TooLong {
        /// The limit.
        expected: usize,
        /// What the frame announces.
        actual: usize,
    },
    /// The reserved field is not zero.
    #[error("a frame's reserved field is {actual}, not 0")]
    Reserved {
        /// What is there.
        actual: u16,
    },
    /// The checksum does not match the bytes.
    #[error("a frame's checksum is {actual:#010x}, its bytes give {expected:#010x}")]
    Checksum {
        /// Computed from the bytes.
        expected: u32,
        /// Found in the frame.
        actual: u32,
    },
}

/// The first 16 bytes in each direction.
#[must_use]
pub fn hello(version: u32) -> [u8; HELLO_LEN] {
    let mut bytes = [0; HELLO_LEN];
    bytes[..8].copy_from_slice(&MAGIC);
    bytes[8..12].copy_from_slice(&version.to_le_bytes());
    bytes[12..].copy_from_slice(&(!version).to_le_bytes());
    bytes
}

/// The protocol version that a greeting announces.
///
/// # Errors
/// When the bytes are no greeting.
pub fn check_hello(bytes: &[u8; HELLO_LEN]) -> Result<u32, FrameError> {
    let version = read_u32(bytes, 8);
    if bytes[..8] != MAGIC || read_u32(bytes, 12) != !version {
        return Err(FrameError::NotAGreeting);
    }
    Ok(version)
}

/// A frame's header, checked as far as it can be without the payload.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Header {
    /// Bytes of payload that follow.
    pub length: usize,
    /// What the payload means.
    pub kind: u16,
    /// The number of the request, repeated in its reply.
    pub sequence: u32,
    crc: u32,
    crc_so_far: u32,
}

impl Header {
    /// Reads a header.
    ///
    /// # Errors
    /// When the length is over the limit, or reserved bits are set.
    pub fn parse(bytes: &[u8; HEADER_LEN]) -> Result<Self, FrameError> {
        let length = read_u32(bytes, 0) as usize;
        let kind = u16::from_le_bytes([bytes[4], bytes[5]]);
        let reserved = u16::from_le_bytes([bytes[6], bytes[7]]);
        if length > MAX_PAYLOAD {
            return Err(FrameError::TooLong {
                expected: MAX_PAYLOAD,
                actual: length,
            });
        }
        if reserved != 0 {
            return Err(FrameError::Reserved { actual: reserved });
        }
        Ok(Self {
            length,
            kind,
            sequence: read_u32(bytes, 8),
            crc: read_u32(bytes, CHECKED),
            crc_so_far: crc32fast::hash(&bytes[..CHECKED]),
        })
    }

    /// Checks the payload against the header's checksum.
    ///
    /// # Errors
    /// When they do not match.
    pub fn check(&self, payload: &[u8]) -> Result<(), FrameError> {
        let expected = checksum(self.crc_so_far, payload);
        if expected == self.crc {
            Ok(())
        } else {
            Err(FrameError::Checksum {
                expected,
                actual: self.crc,
            })
        }
    }
}

/// Appends a whole frame to `out`.
pub fn write(out: &mut Vec<u8>, kind: u16, sequence: u32, payload: &[u8]) {
    let start = out.len();
    let length = u32::try_from(payload.len()).unwrap_or(u32::MAX);
    out.extend_from_slice(&length.to_le_bytes());
    out.extend_from_slice(&kind.to_le_bytes());
    out.extend_from_slice(&[0, 0]);
    out.extend_from_slice(&sequence.to_le_bytes());
    let crc = checksum(crc32fast::hash(&out[start..]), payload);
    out.extend_from_slice(&crc.to_le_bytes());
    out.extend_from_slice(payload);
}

fn checksum(so_far: u32, payload: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new_with_initial(so_far);
    hasher.update(payload);
    hasher.finalize()
}

fn read_u32(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
}
