//! The record of a slot: written last, in one piece, and proof that the artefact before it was finished.

use ted_policy::crc32;

/// Bytes of a record.
pub(super) const LENGTH: usize = 32;

const MAGIC: u32 = u32::from_le_bytes(*b"TEDs");

/// What a record says. Six numbers, little-endian: the magic, the fields in order, and a CRC-32 of the 20 bytes before
/// it; the rest is as the erased flash left it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Record {
    /// Bytes of the artefact.
    pub(super) length: u32,
    /// The checksum in its header.
    pub(super) checksum: u32,
    /// Rises by one with every artefact that is finished.
    pub(super) generation: u32,
    /// What must be the same for the same wiring: known even when the artefact can be read no more.
    pub(super) wiring: u32,
}

const CHECKED: usize = 20;

impl Record {
    /// The record at the start of these bytes, if there is a whole one.
    pub(super) fn read(bytes: &[u8]) -> Option<Self> {
        let (words, _) = bytes.get(..CHECKED + 4)?.as_chunks::<4>();
        let &[magic, length, checksum, generation, wiring, crc] = words else {
            return None;
        };
        let whole = u32::from_le_bytes(magic) == MAGIC
            && u32::from_le_bytes(crc) == crc32(&[bytes.get(..CHECKED)?]);
        whole.then_some(Self {
            length: u32::from_le_bytes(length),
            checksum: u32::from_le_bytes(checksum),
            generation: u32::from_le_bytes(generation),
            wiring: u32::from_le_bytes(wiring),
        })
    }

    /// As it is written.
    pub(super) fn bytes(self) -> [u8; LENGTH] {
        let mut bytes = [0xff; LENGTH];
        let fields = [
            MAGIC,
            self.length,
            self.checksum,
            self.generation,
            self.wiring,
        ];
        let (words, _) = bytes.as_chunks_mut::<4>();
        for (word, field) in words.iter_mut().zip(fields) {
            *word = field.to_le_bytes();
        }
        let (checked, rest) = bytes.split_at_mut(CHECKED);
        if let Some(crc) = rest.first_chunk_mut::<4>() {
            *crc = crc32(&[checked]).to_le_bytes();
        }
        bytes
    }
}
