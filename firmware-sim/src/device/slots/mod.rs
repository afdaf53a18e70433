//! Two slots for artefacts in one flash: one flies while the other is written, and a power cut at any byte leaves one whole.
//!
//! A slot is half of the flash: an artefact at its start, and a record in its last sector. The record is erased before
//! anything else of the slot is touched and written when the artefact has been judged, so it vouches for the bytes before
//! it. Of two artefacts that pass, the one written later flies.

mod judge;
mod record;
mod survey;
mod transfer;

use embedded_storage::nor_flash::NorFlash;
use serde::{Deserialize, Serialize};

use super::MappedFlash;
use super::message::Refusal;

pub(super) use judge::refusal;
pub use survey::{Active, Survey, survey};
pub use transfer::Transfer;

/// What is in a slot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum SlotReport {
    /// Nothing that was ever finished.
    #[default]
    Empty,
    /// The artefact that flies.
    Active {
        /// The checksum in its header.
        checksum: u32,
    },
    /// An older artefact, looked at when the other one fails.
    Standby {
        /// The checksum in its header.
        checksum: u32,
    },
    /// An artefact that was finished and does not fly any more.
    Refused(Refusal),
}

/// Where things are in a flash of `capacity` bytes with sectors of `sector` bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    capacity: u32,
    sector: u32,
}

impl Layout {
    /// Of this flash.
    pub fn of<F: MappedFlash>(flash: &F) -> Self {
        const {
            assert!(F::ERASE_SIZE.is_multiple_of(16) && F::ERASE_SIZE >= record::LENGTH);
            assert!(
                F::WRITE_SIZE <= record::LENGTH && record::LENGTH.is_multiple_of(F::WRITE_SIZE)
            );
        }
        Self::new(
            flash.bytes().len() as u32,
            <F as NorFlash>::ERASE_SIZE as u32,
        )
    }

    /// Of any flash; sectors must not be empty.
    #[must_use]
    pub const fn new(capacity: u32, sector: u32) -> Self {
        Self { capacity, sector }
    }

    /// Bytes of a slot: as many whole sectors as fit into half of the flash.
    #[must_use]
    pub const fn slot_bytes(self) -> u32 {
        match (self.capacity / 2).checked_rem(self.sector) {
            Some(rest) => self.capacity / 2 - rest,
            None => 0,
        }
    }

    /// The largest artefact that fits: all of a slot but the record's sector.
    #[must_use]
    pub const fn room(self) -> u32 {
        self.slot_bytes().saturating_sub(self.sector)
    }

    /// Where a slot starts.
    #[must_use]
    pub const fn start(self, slot: u8) -> u32 {
        (slot as u32).wrapping_mul(self.slot_bytes())
    }

    /// Where its record starts: the last sector.
    #[must_use]
    pub const fn record(self, slot: u8) -> u32 {
        self.start(slot).wrapping_add(self.room())
    }
}
