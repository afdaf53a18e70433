//! Which slot flies, found out from the flash alone.

use ted_policy::ArtifactError;

use super::judge::judge;
use super::record::{self, Record};
use super::refusal;
use super::{Layout, SlotReport};
use crate::controller::Numeric;
use crate::device::MappedFlash;
use crate::device::message::{Name, Refusal};

/// The artefact that flies.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Active {
    /// Its slot.
    pub slot: u8,
    /// Its length in bytes.
    pub length: u32,
    /// The checksum in its header.
    pub checksum: u32,
    /// The task it was trained for, as far as a greeting has room.
    pub task: Name,
    /// Whether it can be flown in integers too.
    pub(super) integers: bool,
    /// What its contract has in common with others of the same wiring.
    pub(super) wiring: u32,
}

/// What is in a flash.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Survey {
    /// The artefact that flies, if one does.
    pub active: Option<Active>,
    /// What is in each slot.
    pub slots: [SlotReport; 2],
    /// The generation of the artefact that was finished last; 0 before the first.
    pub(super) newest: u32,
}

impl Active {
    /// The artefact in this flash.
    pub fn bytes<'f, F: MappedFlash>(&self, flash: &'f F) -> &'f [u8] {
        artefact(flash, self.slot, self.length).unwrap_or_default()
    }
}

impl Survey {
    /// What flies in these numbers.
    ///
    /// # Errors
    /// [`Refusal::NoPolicy`], or the defect that the policy has none.
    pub(in crate::device) fn flies(&self, numeric: Numeric) -> Result<&Active, Refusal> {
        match &self.active {
            None => Err(Refusal::NoPolicy),
            Some(active) if numeric == Numeric::Integer && !active.integers => {
                Err(refusal(ArtifactError::NoIntegers))
            }
            Some(active) => Ok(active),
        }
    }

    /// The slot that may be overwritten: the one that does not fly.
    #[must_use]
    pub fn inactive(&self) -> u8 {
        match &self.active {
            Some(active) => 1 - active.slot.min(1),
            None => 0,
        }
    }
}

/// Looks at both slots, the one that was finished later first, until one holds an artefact that passes everything. An older
/// artefact for another wiring never flies.
#[inline(never)]
pub fn survey<F: MappedFlash>(flash: &F) -> Survey {
    let mut found = Survey::default();
    let records = [0, 1].map(|slot| read_record(flash, slot));
    let generation = |record: Option<Record>| record.map_or(0, |record| record.generation);
    let [first, second] = records.map(generation);
    found.newest = first.max(second);
    let order = if second > first { [1, 0] } else { [0, 1] };
    let mut wiring = None;
    for slot in order {
        let [first, second] = records;
        let Some(record) = (if slot == 0 { first } else { second }) else {
            continue;
        };
        // The robot is wired for the artefact that was finished last, even if that one can fly no more.
        let report = if *wiring.get_or_insert(record.wiring) != record.wiring {
            SlotReport::Refused(Refusal::OtherContract)
        } else if found.active.is_some() {
            SlotReport::Standby {
                checksum: record.checksum,
            }
        } else {
            match examine(flash, slot, record) {
                Ok(active) => {
                    let checksum = active.checksum;
                    found.active = Some(active);
                    SlotReport::Active { checksum }
                }
                Err(refusal) => SlotReport::Refused(refusal),
            }
        };
        if let Some(place) = found.slots.get_mut(usize::from(slot)) {
            *place = report;
        }
    }
    found
}

/// Judges the artefact that a record vouches for.
pub(super) fn examine<F: MappedFlash>(
    flash: &F,
    slot: u8,
    record: Record,
) -> Result<Active, Refusal> {
    let limit = Layout::of(flash).room();
    let bytes = artefact(flash, slot, record.length).ok_or(Refusal::TooLarge { limit })?;
    let judged = judge(bytes)?;
    if judged.checksum != record.checksum {
        return Err(Refusal::Checksum {
            expected: record.checksum,
            actual: judged.checksum,
        });
    }
    Ok(Active {
        slot,
        length: record.length,
        checksum: judged.checksum,
        task: judged.task,
        integers: judged.integers,
        wiring: judged.wiring,
    })
}

fn artefact<F: MappedFlash>(flash: &F, slot: u8, length: u32) -> Option<&[u8]> {
    let layout = Layout::of(flash);
    if length > layout.room() {
        return None;
    }
    let start = layout.start(slot) as usize;
    flash.bytes().get(start..)?.get(..length as usize)
}

pub(super) fn read_record<F: MappedFlash>(flash: &F, slot: u8) -> Option<Record> {
    let at = Layout::of(flash).record(slot) as usize;
    Record::read(flash.bytes().get(at..)?.get(..record::LENGTH)?)
}
