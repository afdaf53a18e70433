//! Memory that behaves as NOR flash: erased in sectors to ones, written by clearing bits, read in place.

use core::slice;

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};
use firmware_sim::device::MappedFlash;

use crate::map::{MAP, SLOTS_SIZE};

const SECTOR: usize = 4096;
const WORD: usize = 4;

/// The flash for artefacts.
pub struct SlotMemory(&'static mut [u8]);

impl SlotMemory {
    /// The board's memory for slots.
    ///
    /// # Safety
    /// Only once in the life of the program.
    pub unsafe fn take() -> Self {
        // SAFETY: the board has this memory, the linker puts nothing there, and the caller takes it once.
        Self(unsafe { slice::from_raw_parts_mut(MAP.slots as *mut u8, SLOTS_SIZE) })
    }

    fn range(&mut self, from: u32, to: u32) -> Result<&mut [u8], NorFlashErrorKind> {
        self.0
            .get_mut(from as usize..to as usize)
            .ok_or(NorFlashErrorKind::OutOfBounds)
    }
}

impl ErrorType for SlotMemory {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for SlotMemory {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, into: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        check_read(self, offset, into.len())?;
        let from = self.range(offset, offset + into.len() as u32)?;
        into.iter_mut().zip(from).for_each(|(to, from)| *to = *from);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.0.len()
    }
}

impl NorFlash for SlotMemory {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = SECTOR;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        check_erase(self, from, to)?;
        self.range(from, to)?.fill(0xff);
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        check_write(self, offset, bytes.len())?;
        let to = self.range(offset, offset + bytes.len() as u32)?;
        to.iter_mut().zip(bytes).for_each(|(to, from)| *to &= from);
        Ok(())
    }
}

impl MappedFlash for SlotMemory {
    fn bytes(&self) -> &[u8] {
        self.0
    }
}
