//! The fixed header in front of everything: what must hold before a byte of metadata is believed.

use crate::crc::crc32;
use crate::error::ArtifactError;

/// The first eight bytes: a byte with the high bit set, the name, and line ends that a text-mode copy would change.
pub const MAGIC: [u8; 8] = *b"\x89TED\r\n\x1a\n";

/// The version of the format that this crate reads and writes.
pub const FORMAT_VERSION: u32 = 2;

/// Length of the header in bytes. The metadata follows it at once.
pub const HEADER_LENGTH: usize = 48;

/// Every array of the blob, and the blob itself, starts at a multiple of this.
pub(crate) const ALIGNMENT: usize = 16;

pub(crate) const VERSION_AT: usize = 8;
pub(crate) const CHECKSUM_AT: usize = 12;
pub(crate) const TOTAL_LENGTH_AT: usize = 16;
pub(crate) const METADATA_OFFSET_AT: usize = 20;
pub(crate) const METADATA_LENGTH_AT: usize = 24;
pub(crate) const BLOB_OFFSET_AT: usize = 28;
pub(crate) const BLOB_LENGTH_AT: usize = 32;
pub(crate) const RESERVED_AT: usize = 36;

/// The two sections behind a header that was checked.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Envelope<'a> {
    pub(crate) checksum: u32,
    pub(crate) metadata: &'a [u8],
    pub(crate) blob: &'a [u8],
    pub(crate) blob_offset: usize,
}

impl<'a> Envelope<'a> {
    /// Checks magic, version, length, checksum and the position of the sections, in this order.
    pub(crate) fn open(bytes: &'a [u8]) -> Result<Self, ArtifactError> {
        let too_short = ArtifactError::TooShort {
            expected: HEADER_LENGTH,
            actual: bytes.len(),
        };
        let (magic, _) = bytes.split_first_chunk::<8>().ok_or(too_short)?;
        if *magic != MAGIC {
            return Err(ArtifactError::WrongMagic {
                expected: MAGIC,
                actual: *magic,
            });
        }
        let version = field(bytes, VERSION_AT).ok_or(too_short)?;
        if version != FORMAT_VERSION {
            return Err(ArtifactError::UnsupportedVersion {
                expected: FORMAT_VERSION,
                actual: version,
            });
        }
        let (header, _) = bytes
            .split_first_chunk::<HEADER_LENGTH>()
            .ok_or(too_short)?;
        let read = |at| field(header, at).ok_or(too_short);

        let (expected, actual) = (read(TOTAL_LENGTH_AT)? as usize, bytes.len());
        if actual < expected {
            return Err(ArtifactError::Truncated { expected, actual });
        }
        if actual > expected {
            return Err(ArtifactError::TrailingBytes { expected, actual });
        }
        let (expected, actual) = (read(CHECKSUM_AT)?, checksum(bytes));
        if actual != expected {
            return Err(ArtifactError::Checksum { expected, actual });
        }

        // Only one layout is valid, so sections can neither overlap nor leave a gap to hide something in.
        let metadata_length = read(METADATA_LENGTH_AT)?;
        let metadata_end = u64::from(metadata_length) + HEADER_LENGTH as u64;
        let blob_offset = metadata_end.next_multiple_of(ALIGNMENT as u64);
        let total = u64::from(read(TOTAL_LENGTH_AT)?);
        if blob_offset > total {
            let expected = total.saturating_sub(HEADER_LENGTH as u64) as u32;
            return Err(ArtifactError::HeaderField {
                offset: METADATA_LENGTH_AT,
                expected,
                actual: metadata_length,
            });
        }
        for (offset, expected) in [
            (METADATA_OFFSET_AT, HEADER_LENGTH as u32),
            (BLOB_OFFSET_AT, blob_offset as u32),
            (BLOB_LENGTH_AT, (total - blob_offset) as u32),
            (RESERVED_AT, 0),
            (RESERVED_AT + 4, 0),
            (RESERVED_AT + 8, 0),
        ] {
            let actual = read(offset)?;
            if actual != expected {
                return Err(ArtifactError::HeaderField {
                    offset,
                    expected,
                    actual,
                });
            }
        }

        let metadata = bytes
            .get(HEADER_LENGTH..metadata_end as usize)
            .ok_or(too_short)?;
        let padding = bytes
            .get(metadata_end as usize..blob_offset as usize)
            .ok_or(too_short)?;
        let blob = bytes.get(blob_offset as usize..).ok_or(too_short)?;
        check_padding(padding, metadata_end as usize)?;
        Ok(Self {
            checksum: expected,
            metadata,
            blob,
            blob_offset: blob_offset as usize,
        })
    }
}

/// Passes when all of `padding`, which starts at byte `offset` of the file, is zero.
pub(crate) fn check_padding(padding: &[u8], offset: usize) -> Result<(), ArtifactError> {
    match padding.iter().position(|byte| *byte != 0) {
        Some(index) => Err(ArtifactError::Padding {
            offset: offset + index,
        }),
        None => Ok(()),
    }
}

/// The CRC-32 of all bytes, those of the checksum itself counted as zeros.
pub(crate) fn checksum(bytes: &[u8]) -> u32 {
    match bytes.split_at_checked(CHECKSUM_AT) {
        Some((before, rest)) => crc32(&[before, &[0; 4], rest.get(4..).unwrap_or_default()]),
        None => crc32(&[]),
    }
}

/// Writes the checksum of all other bytes into the header.
#[cfg(feature = "std")]
pub(crate) fn stamp(bytes: &mut [u8]) {
    let checksum = checksum(bytes).to_le_bytes();
    for (target, source) in bytes.iter_mut().skip(CHECKSUM_AT).zip(checksum) {
        *target = source;
    }
}

pub(crate) fn field(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk::<4>()?))
}
