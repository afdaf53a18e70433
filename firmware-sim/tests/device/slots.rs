//! Two slots: whatever happens to one, the other flies.

use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};
use firmware_sim::bench::{FlashFault, HostBoard, MemoryFlash, cable};
use firmware_sim::device::message::{FlashBegin, Refusal, Start};
use firmware_sim::device::slots::{SlotReport, Survey, Transfer, survey};
use firmware_sim::device::{MappedFlash, serve};
use firmware_sim::plants::toy::{ToyPlant, artifact_spec};
use firmware_sim::remote::{Connection, Flashed, Progress, RemoteController, RemoteError, flash};
use firmware_sim::rollout::fly_episode;
use ted_policy::{Artifact, write};

use super::artefacts::{
    FLASH_BYTES, QUICK, checksum, connected, flash_with, other_artefact, rewired_artefact,
    toy_artefact,
};

fn flying(found: &Survey) -> Option<(u8, u32)> {
    let active = found.active.as_ref()?;
    Some((active.slot, active.checksum))
}

/// As a device takes an artefact, in chunks.
fn put(memory: &mut MemoryFlash, artefact: &[u8]) -> Result<u32, Refusal> {
    let found = survey(memory);
    let announced = FlashBegin {
        length: artefact.len() as u32,
        checksum: checksum(artefact),
        accept_other_contract: false,
    };
    let mut transfer = Transfer::begin(memory, &found, announced)?;
    for (index, chunk) in artefact.chunks(512).enumerate() {
        transfer.write(memory, 512 * index as u32, chunk)?;
    }
    Ok(transfer.commit(memory, &found)?.checksum)
}

#[test]
fn an_artefact_that_is_sent_flies_from_the_other_slot() {
    let (old, new) = (toy_artefact(), other_artefact());
    let mut connection = connected(flash_with(&[&old]));
    let hello = connection.hello().clone();
    assert_eq!((hello.active, hello.task.as_str()), (Some(0), "toy-reach"));
    assert_eq!(hello.slot_bytes, 3 * 4096);
    let mut heard = Vec::new();
    let flashed = flash(&mut connection, &new, false, |progress| {
        heard.push(progress)
    })
    .unwrap();
    let expected = Flashed {
        slot: 1,
        checksum: checksum(&new),
    };
    assert_eq!(flashed, expected);
    let total = new.len();
    assert_eq!(heard.first(), Some(&Progress { sent: 0, total }));
    assert_eq!(heard.last(), Some(&Progress { sent: total, total }));
    let hello = connection.hello();
    assert_eq!(hello.active, Some(1));
    let standby = SlotReport::Standby {
        checksum: checksum(&old),
    };
    assert_eq!(hello.slots[0], standby);

    let memory = connection.into_stream().power_off();
    let found = survey(&memory);
    assert_eq!(flying(&found), Some((1, checksum(&new))));
    let active = found.active.unwrap();
    assert_eq!(active.bytes(&memory), new);
    assert!(Artifact::parse(active.bytes(&memory)).is_ok());
}

#[test]
fn power_that_goes_at_any_byte_leaves_the_old_policy_flying() {
    let (old, new) = (toy_artefact(), other_artefact());
    // The worst start: the slot to be written holds an older artefact, so everything in it has to change.
    let before = flash_with(&[&new, &old]);
    let mut whole = before.clone();
    put(&mut whole, &new).unwrap();
    let (from, to) = (before.changed(), whole.changed());
    assert!(
        to - from > 8192 + new.len() as u64,
        "two sectors and all bytes"
    );
    for cut_at in from..to {
        let mut memory = before.clone();
        memory.cut_power_at(cut_at);
        assert_eq!(
            put(&mut memory, &new),
            Err(Refusal::Flash),
            "cut at {cut_at}"
        );
        memory.restore_power();
        let flying_now = flying(&survey(&memory));
        // The last byte of the record's checksum is what decides; half of it may already be all of it.
        let is_old = flying_now == Some((1, checksum(&old)));
        let is_new = flying_now == Some((0, checksum(&new)));
        assert!(is_old || is_new && cut_at + 32 >= to, "cut at {cut_at}");
        let next = if is_new { &old } else { &new };
        assert_eq!(
            put(&mut memory, next),
            Ok(checksum(next)),
            "after a cut at {cut_at}"
        );
        let then = flying(&survey(&memory));
        assert_eq!(then.map(|(_, sum)| sum), Some(checksum(next)));
    }
}

#[test]
fn a_slot_that_rots_leaves_the_older_artefact_flying() {
    let (old, new) = (toy_artefact(), other_artefact());
    let whole = flash_with(&[&old, &new]);
    assert_eq!(flying(&survey(&whole)), Some((1, checksum(&new))));
    let start = FLASH_BYTES / 2;
    for at in (0..new.len()).step_by(7) {
        let mut memory = whole.clone();
        memory.content()[start + at] ^= 0x10;
        let found = survey(&memory);
        assert_eq!(flying(&found), Some((0, checksum(&old))), "byte {at}");
        assert!(
            matches!(found.slots[1], SlotReport::Refused(_)),
            "byte {at}"
        );
    }
    for at in 0..24 {
        let mut memory = whole.clone();
        memory.content()[FLASH_BYTES - 4096 + at] ^= 1;
        let found = survey(&memory);
        assert_eq!(
            flying(&found),
            Some((0, checksum(&old))),
            "record byte {at}"
        );
        assert_eq!(found.slots[1], SlotReport::Empty);
    }
}

#[test]
fn two_slots_that_rotted_fly_nothing_and_take_a_new_artefact() {
    let (old, new) = (toy_artefact(), other_artefact());
    let mut memory = flash_with(&[&old, &new]);
    memory.content()[100] ^= 1;
    memory.content()[FLASH_BYTES / 2 + 100] ^= 1;
    let mut connection = connected(memory);
    assert_eq!(connection.hello().active, None);
    assert!(
        connection
            .hello()
            .slots
            .iter()
            .all(|slot| matches!(slot, SlotReport::Refused(Refusal::Checksum { .. })))
    );
    flash(&mut connection, &new, false, |_| {}).unwrap();
    assert_eq!(connection.hello().active, Some(0));
}

fn refused(artefact: &[u8]) -> (Refusal, String) {
    let old = toy_artefact();
    let mut connection = connected(flash_with(&[&old]));
    let error = flash(&mut connection, artefact, false, |_| {}).unwrap_err();
    connection.greet().unwrap();
    assert_eq!(
        connection.hello().active,
        Some(0),
        "the old policy flies on"
    );
    let RemoteError::Refused { refusal, .. } = error else {
        panic!("{error}");
    };
    let mut memory = connection.into_stream().power_off();
    assert_eq!(flying(&survey(&memory)), Some((0, checksum(&old))));
    assert_eq!(
        put(&mut memory, &other_artefact()),
        Ok(checksum(&other_artefact()))
    );
    (refusal, refusal.to_string())
}

#[test]
fn an_artefact_of_a_robot_that_nobody_declared_is_refused_with_the_way_out() {
    let mut spec = artifact_spec().unwrap();
    spec.contract = spec.contract.undeclared();
    let (refusal, words) = refused(&write(&spec).unwrap());
    assert_eq!(refusal, Refusal::Undeclared);
    assert!(words.contains("`ted robot draft DATASET`"), "{words}");
}

#[test]
fn an_artefact_of_another_contract_is_refused_unless_that_is_accepted() {
    let rewired = rewired_artefact();
    let (refusal, words) = refused(&rewired);
    assert_eq!(refusal, Refusal::OtherContract);
    assert!(
        words.contains("channels, units or control period"),
        "{words}"
    );
    let mut connection = connected(flash_with(&[&toy_artefact()]));
    flash(&mut connection, &rewired, true, |_| {}).unwrap();
    assert_eq!(connection.hello().active, Some(1));
}

#[test]
fn after_a_rewiring_the_policy_for_the_old_wiring_never_flies_again() {
    let (old, rewired) = (toy_artefact(), rewired_artefact());
    let whole = flash_with(&[&old, &rewired]);
    assert_eq!(flying(&survey(&whole)), Some((1, checksum(&rewired))));
    let start = FLASH_BYTES / 2;
    // Neither when the artefact rots nor when its record does.
    for at in [start + 200, FLASH_BYTES - 4096] {
        let mut memory = whole.clone();
        memory.content()[at] ^= 0x10;
        assert_eq!(flying(&survey(&memory)), None, "byte {at}");
    }
}

#[test]
fn power_that_goes_while_a_rewiring_is_finished_does_not_bring_the_old_wiring_back() {
    let (old, rewired) = (toy_artefact(), rewired_artefact());
    let before = flash_with(&[&old]);
    let whole = flash_with(&[&old, &rewired]);
    // The last sector to be erased is the old record's.
    for cut_at in whole.changed() - 4096..whole.changed() {
        let mut memory = before.clone();
        let found = survey(&memory);
        let announced = FlashBegin {
            length: rewired.len() as u32,
            checksum: checksum(&rewired),
            accept_other_contract: true,
        };
        let mut transfer = Transfer::begin(&mut memory, &found, announced).unwrap();
        transfer.write(&mut memory, 0, &rewired).unwrap();
        memory.cut_power_at(cut_at);
        let committed = transfer.commit(&mut memory, &found).unwrap();
        assert_eq!(committed.checksum, checksum(&rewired));
        memory.restore_power();
        assert_eq!(flying(&survey(&memory)), Some((1, checksum(&rewired))));
        memory.content()[FLASH_BYTES / 2 + 200] ^= 1;
        assert_eq!(flying(&survey(&memory)), None, "cut at {cut_at}");
    }
}

#[test]
fn a_damaged_artefact_is_refused_by_name() {
    let mut artefact = other_artefact();
    let last = artefact.len() - 1;
    artefact[last] ^= 1;
    let (refusal, words) = refused(&artefact);
    assert!(
        matches!(refusal, Refusal::Checksum { expected, .. } if expected == checksum(&artefact))
    );
    assert!(words.contains("checksum"), "{words}");

    let mut artefact = other_artefact();
    artefact[0] ^= 1;
    assert_eq!(refused(&artefact).0, Refusal::Defect { code: 2 });
    assert_eq!(
        refused(&other_artefact()[..100]).0,
        Refusal::Defect { code: 4 }
    );
    assert_eq!(refused(&[]).0, Refusal::Defect { code: 1 });
}

#[test]
fn an_artefact_that_this_machine_computes_differently_is_refused() {
    let mut artefact = other_artefact();
    let golden = artefact.len() - 16;
    artefact[golden] ^= 1;
    artefact[12..16].fill(0);
    let checksum = crc32fast::hash(&artefact);
    artefact[12..16].copy_from_slice(&checksum.to_le_bytes());
    assert!(matches!(refused(&artefact).0, Refusal::Golden { .. }));
}

#[test]
fn a_device_whose_flash_fails_says_so_and_flies_on() {
    let old = toy_artefact();
    for after in [0, 4000, 5000, 9000] {
        let mut memory = flash_with(&[&old]);
        memory.cut_power_at(memory.changed() + after);
        let mut connection = connected(memory);
        let error = flash(&mut connection, &other_artefact(), false, |_| {}).unwrap_err();
        let is_flash = |refusal| refusal == Refusal::Flash;
        assert!(
            matches!(error, RemoteError::Refused { refusal, .. } if is_flash(refusal)),
            "{error}"
        );
        connection.greet().unwrap();
        assert_eq!(connection.hello().active, Some(0));
        let mut pilot = RemoteController::new(connection, Start::default());
        let (report, _) = fly_episode(&mut pilot, &mut ToyPlant::new(), 7).unwrap();
        assert!(report.success);
    }
}

#[test]
fn an_artefact_that_does_not_fit_is_refused_before_anything_is_erased() {
    let old = toy_artefact();
    let memory = flash_with(&[&old, &other_artefact()]);
    let changed = memory.changed();
    let mut connection = connected(memory);
    let error = flash(&mut connection, &[0; 3 * 4096 + 1], false, |_| {}).unwrap_err();
    let expected = Refusal::TooLarge { limit: 3 * 4096 };
    assert!(matches!(error, RemoteError::Refused { refusal, .. } if refusal == expected));
    assert_eq!(connection.into_stream().power_off().changed(), changed);
}

#[test]
fn an_artefact_as_large_as_a_slot_is_taken_whole() {
    let mut memory = flash_with(&[&toy_artefact()]);
    let found = survey(&memory);
    let announced = FlashBegin {
        length: 3 * 4096,
        checksum: 0,
        accept_other_contract: false,
    };
    let mut transfer = Transfer::begin(&mut memory, &found, announced).unwrap();
    for offset in (0..3 * 4096).step_by(512) {
        transfer.write(&mut memory, offset, &[7; 512]).unwrap();
    }
    let refusal = transfer.commit(&mut memory, &found).unwrap_err();
    assert_eq!(refusal, Refusal::Defect { code: 2 });
    assert_eq!(flying(&survey(&memory)), flying(&found));
}

#[test]
fn bytes_that_are_not_the_next_ones_are_refused_and_change_nothing() {
    let mut memory = flash_with(&[&toy_artefact()]);
    let found = survey(&memory);
    let announced = FlashBegin {
        length: 600,
        checksum: 0,
        accept_other_contract: false,
    };
    let mut transfer = Transfer::begin(&mut memory, &found, announced).unwrap();
    transfer.write(&mut memory, 0, &[1; 512]).unwrap();
    let changed = memory.changed();
    let expected = Err(Refusal::Offset { expected: 512 });
    for (offset, length) in [(0, 512), (516, 84), (512, 89), (512, 5), (u32::MAX, 4)] {
        assert_eq!(
            transfer.write(&mut memory, offset, &vec![1; length]),
            expected
        );
    }
    assert_eq!(transfer.commit(&mut memory, &found).map(|_| ()), expected);
    assert_eq!(memory.changed(), changed);
    assert_eq!(transfer.write(&mut memory, 512, &[1; 88]), Ok(()));
}

/// A flash that says it has written a record and has not.
struct Forgetful(MemoryFlash);

impl ErrorType for Forgetful {
    type Error = FlashFault;
}

impl ReadNorFlash for Forgetful {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashFault> {
        self.0.read(offset, bytes)
    }

    fn capacity(&self) -> usize {
        self.0.capacity()
    }
}

impl NorFlash for Forgetful {
    const WRITE_SIZE: usize = MemoryFlash::WRITE_SIZE;
    const ERASE_SIZE: usize = MemoryFlash::ERASE_SIZE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashFault> {
        self.0.erase(from, to)
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashFault> {
        match offset as usize == FLASH_BYTES - Self::ERASE_SIZE {
            true => Ok(()),
            false => self.0.write(offset, bytes),
        }
    }
}

impl MappedFlash for Forgetful {
    fn bytes(&self) -> &[u8] {
        self.0.bytes()
    }
}

#[test]
fn a_record_that_was_not_written_is_noticed_before_the_answer() {
    let old = toy_artefact();
    let mut memory = Forgetful(flash_with(&[&old]));
    let (near, far) = cable();
    let device = std::thread::spawn(move || serve(far, &mut memory, &mut HostBoard::new()));
    let mut connection = Connection::open(near, QUICK).unwrap();
    let error = flash(&mut connection, &other_artefact(), false, |_| {}).unwrap_err();
    assert!(
        matches!(error, RemoteError::Refused { refusal, .. } if refusal == Refusal::Flash),
        "{error}"
    );
    drop(connection);
    device.join().unwrap();
}
