//! Putting an artefact into the slot that does not fly.

use embedded_storage::nor_flash::NorFlash;

use super::record::{self, Record};
use super::survey::{examine, read_record};
use super::{Active, Layout, Survey};
use crate::device::MappedFlash;
use crate::device::message::{FlashBegin, Refusal};

/// An artefact on its way into a slot.
///
/// Sectors are erased when the bytes reach them, so that no request takes longer than one erasure.
#[derive(Clone, Debug)]
pub struct Transfer {
    slot: u8,
    announced: FlashBegin,
    /// Bytes written.
    written: u32,
    /// Bytes of the slot that are erased or written.
    erased: u32,
}

impl Transfer {
    /// Whether such an artefact could be taken; nothing is touched.
    ///
    /// # Errors
    /// [`Refusal::TooLarge`].
    pub fn fits<F: MappedFlash>(flash: &F, announced: &FlashBegin) -> Result<(), Refusal> {
        let limit = Layout::of(flash).room();
        if announced.length > limit {
            return Err(Refusal::TooLarge { limit });
        }
        Ok(())
    }

    /// Makes the slot's old artefact invalid.
    ///
    /// # Errors
    /// [`Refusal::TooLarge`], before anything is touched, or [`Refusal::Flash`].
    pub fn begin<F: MappedFlash>(
        flash: &mut F,
        survey: &Survey,
        announced: FlashBegin,
    ) -> Result<Self, Refusal> {
        Self::fits(flash, &announced)?;
        let (layout, slot) = (Layout::of(flash), survey.inactive());
        erase(flash, layout.record(slot))?;
        Ok(Self {
            slot,
            announced,
            written: 0,
            erased: 0,
        })
    }

    /// Writes the next bytes. All but the last must be a multiple of the flash's `WRITE_SIZE`.
    ///
    /// # Errors
    /// [`Refusal::Offset`] when these are not the next ones, or [`Refusal::Flash`].
    pub fn write<F: MappedFlash>(
        &mut self,
        flash: &mut F,
        offset: u32,
        bytes: &[u8],
    ) -> Result<(), Refusal> {
        let expected = Refusal::Offset {
            expected: self.written,
        };
        let end = offset.checked_add(bytes.len() as u32).ok_or(expected)?;
        let (units, rest) = bytes.split_at(bytes.len() - bytes.len() % F::WRITE_SIZE);
        let last = end == self.announced.length;
        if offset != self.written || end > self.announced.length || !(rest.is_empty() || last) {
            return Err(expected);
        }
        let start = Layout::of(flash).start(self.slot);
        while self.erased < end {
            erase(flash, start + self.erased)?;
            self.erased += F::ERASE_SIZE as u32;
        }
        flash
            .write(start + offset, units)
            .map_err(|_| Refusal::Flash)?;
        if !rest.is_empty() {
            let mut padded = [0xff; record::LENGTH];
            for (place, byte) in padded.iter_mut().zip(rest) {
                *place = *byte;
            }
            let unit = padded.get(..F::WRITE_SIZE).unwrap_or_default();
            flash
                .write(start + offset + units.len() as u32, unit)
                .map_err(|_| Refusal::Flash)?;
        }
        self.written = end;
        Ok(())
    }

    /// Judges what was written, and lets it fly from now on.
    ///
    /// # Errors
    /// [`Refusal::Offset`] when bytes are missing, what is wrong with the artefact, [`Refusal::OtherContract`], or
    /// [`Refusal::Flash`].
    pub fn commit<F: MappedFlash>(
        &self,
        flash: &mut F,
        survey: &Survey,
    ) -> Result<Active, Refusal> {
        if self.written != self.announced.length {
            return Err(Refusal::Offset {
                expected: self.written,
            });
        }
        let mut record = Record {
            length: self.announced.length,
            checksum: self.announced.checksum,
            generation: survey.newest.saturating_add(1),
            wiring: 0,
        };
        let fresh = examine(flash, self.slot, record)?;
        record.wiring = fresh.wiring;
        let same = |active: &Active| active.wiring == fresh.wiring;
        if !self.announced.accept_other_contract && !survey.active.as_ref().is_none_or(same) {
            return Err(Refusal::OtherContract);
        }
        flash
            .write(Layout::of(flash).record(self.slot), &record.bytes())
            .map_err(|_| Refusal::Flash)?;
        let other = 1 - self.slot.min(1);
        if read_record(flash, other).is_some_and(|old| old.wiring != record.wiring) {
            // The new record keeps it from flying, and this does when that record rots as well. So a failure is none of the
            // new artefact's.
            let _ = erase(flash, Layout::of(flash).record(other));
        }
        Ok(fresh)
    }
}

/// Erases the sector at this offset.
fn erase<F: NorFlash>(flash: &mut F, offset: u32) -> Result<(), Refusal> {
    flash
        .erase(offset, offset.saturating_add(F::ERASE_SIZE as u32))
        .map_err(|_| Refusal::Flash)
}
