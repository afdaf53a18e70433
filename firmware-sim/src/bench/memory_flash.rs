//! NOR flash in memory, with what makes real flash hard to use: a sector can only be erased whole, programming only clears
//! bits, and the power can go in the middle of either.

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash, check_erase, check_read,
    check_write,
};

use crate::device::MappedFlash;
use crate::device::message::{FlashBegin, Refusal};
use crate::device::slots::{Transfer, survey};

/// Bytes of a sector.
const SECTOR: usize = 4096;
/// Bytes that are programmed at once.
const WORD: usize = 4;
/// What an erased byte reads.
const ERASED: u8 = 0xff;

/// A flash whose content outlives the device that it is in.
#[derive(Clone, Debug)]
pub struct MemoryFlash {
    /// 16 bytes each, because that is how a flash has to be aligned.
    lines: Vec<u128>,
    /// Bytes changed so far.
    changed: u64,
    /// After how many changed bytes the power goes.
    cut_at: Option<u64>,
}

/// Why an operation was not done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlashFault {
    /// A place that is not in the flash, or not the start of a sector or a word.
    Place(NorFlashErrorKind),
    /// Programming would have to set a bit: the sector was not erased.
    NotErased,
    /// The power is gone.
    NoPower,
}

impl MemoryFlash {
    /// An erased flash of at least so many bytes: whole sectors.
    #[must_use]
    pub fn erased(bytes: usize) -> Self {
        Self::holding(&vec![ERASED; bytes.next_multiple_of(SECTOR)])
    }

    /// A flash with this content, up to a whole sector.
    #[must_use]
    pub fn holding(content: &[u8]) -> Self {
        let bytes = content.len().next_multiple_of(SECTOR);
        let mut flash = Self {
            lines: vec![u128::MAX; bytes / 16],
            changed: 0,
            cut_at: None,
        };
        flash.content()[..content.len()].copy_from_slice(content);
        flash
    }

    /// A flash of so many bytes in which these artefacts were put one after the other, the last of which flies; so two of
    /// them can be held.
    ///
    /// # Errors
    /// What a device would have said.
    pub fn with_artefacts(bytes: usize, artefacts: &[&[u8]]) -> Result<Self, Refusal> {
        let mut flash = Self::erased(bytes);
        for artefact in artefacts {
            let checksum = artefact.get(12..).and_then(<[u8]>::first_chunk);
            let announced = FlashBegin {
                length: artefact.len() as u32,
                checksum: checksum.map_or(0, |bytes| u32::from_le_bytes(*bytes)),
                accept_other_contract: true,
            };
            let found = survey(&flash);
            let mut transfer = Transfer::begin(&mut flash, &found, announced)?;
            transfer.write(&mut flash, 0, artefact)?;
            transfer.commit(&mut flash, &found)?;
        }
        Ok(flash)
    }

    /// The content, to damage it as no operation could.
    pub fn content(&mut self) -> &mut [u8] {
        bytemuck::cast_slice_mut(&mut self.lines)
    }

    /// Bytes that erasing and programming have changed so far: the clock by which power is cut.
    #[must_use]
    pub fn changed(&self) -> u64 {
        self.changed
    }

    /// Lets the power go when so many bytes have been changed, in the middle of the next one. Everything after that fails.
    pub fn cut_power_at(&mut self, changed: u64) {
        self.cut_at = Some(changed);
    }

    /// Gives the power back.
    pub fn restore_power(&mut self) {
        self.cut_at = None;
    }

    /// Brings one byte to its new value. Where the power goes, half of its bits have changed.
    fn change(&mut self, at: usize, new: u8) -> Result<(), FlashFault> {
        const HALF: u8 = 0b0101_0101;
        let gone = self.cut_at.map(|cut_at| self.changed.cmp(&cut_at));
        let byte = &mut bytemuck::cast_slice_mut::<u128, u8>(&mut self.lines)[at];
        match gone {
            Some(std::cmp::Ordering::Greater) => Err(FlashFault::NoPower),
            Some(std::cmp::Ordering::Equal) => {
                *byte = (*byte & !HALF) | (new & HALF);
                self.changed += 1;
                Err(FlashFault::NoPower)
            }
            _ => {
                *byte = new;
                self.changed += 1;
                Ok(())
            }
        }
    }
}

impl MappedFlash for MemoryFlash {
    fn bytes(&self) -> &[u8] {
        bytemuck::cast_slice(&self.lines)
    }
}

impl ErrorType for MemoryFlash {
    type Error = FlashFault;
}

impl ReadNorFlash for MemoryFlash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashFault> {
        check_read(self, offset, bytes.len())?;
        bytes.copy_from_slice(&self.bytes()[offset as usize..][..bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes().len()
    }
}

impl NorFlash for MemoryFlash {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = SECTOR;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashFault> {
        check_erase(self, from, to)?;
        (from as usize..to as usize).try_for_each(|at| self.change(at, ERASED))
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashFault> {
        check_write(self, offset, bytes.len())?;
        for (at, &byte) in (offset as usize..).zip(bytes) {
            if self.bytes()[at] & byte != byte {
                return Err(FlashFault::NotErased);
            }
            self.change(at, byte)?;
        }
        Ok(())
    }
}

impl NorFlashError for FlashFault {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::Place(kind) => *kind,
            Self::NotErased | Self::NoPower => NorFlashErrorKind::Other,
        }
    }
}

impl From<NorFlashErrorKind> for FlashFault {
    fn from(kind: NorFlashErrorKind) -> Self {
        Self::Place(kind)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programming_only_clears_bits() {
        let mut flash = MemoryFlash::erased(SECTOR);
        assert_eq!(flash.write(0, &[0xf0; 4]), Ok(()));
        assert_eq!(flash.write(0, &[0x30; 4]), Ok(()));
        assert_eq!(flash.write(0, &[0x40; 4]), Err(FlashFault::NotErased));
        assert_eq!(flash.bytes()[..5], [0x30, 0x30, 0x30, 0x30, ERASED]);
        assert_eq!(flash.erase(0, SECTOR as u32), Ok(()));
        assert_eq!(flash.write(0, &[0x40; 4]), Ok(()));
    }

    #[test]
    fn only_whole_words_and_sectors_can_be_touched() {
        let mut flash = MemoryFlash::erased(2 * SECTOR);
        let not_aligned = Err(FlashFault::Place(NorFlashErrorKind::NotAligned));
        let out_of_bounds = Err(FlashFault::Place(NorFlashErrorKind::OutOfBounds));
        assert_eq!(flash.write(2, &[0; 4]), not_aligned);
        assert_eq!(flash.write(0, &[0; 3]), not_aligned);
        assert_eq!(flash.erase(0, 16), not_aligned);
        assert_eq!(flash.erase(0, 3 * SECTOR as u32), out_of_bounds);
    }

    #[test]
    fn where_the_power_goes_a_byte_is_half_done_and_nothing_follows() {
        let mut flash = MemoryFlash::erased(SECTOR);
        flash.cut_power_at(2);
        assert_eq!(flash.write(0, &[0; 4]), Err(FlashFault::NoPower));
        assert_eq!(flash.bytes()[..4], [0, 0, 0b1010_1010, ERASED]);
        assert_eq!(flash.write(8, &[0; 4]), Err(FlashFault::NoPower));
        assert_eq!(flash.bytes()[8], ERASED);
        flash.restore_power();
        assert_eq!(flash.write(8, &[0; 4]), Ok(()));
    }
}
