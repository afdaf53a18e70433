//! The plug is pulled while an artefact is sent: what flew before flies on, from the same file of flash.

use std::fs;
use std::thread;
use std::time::{Duration, Instant};

use firmware_sim::controller::Numeric;
use firmware_sim::device::message::{FlashBegin, Request};
use firmware_sim::device::slots::SlotReport;
use firmware_sim::plants::toy::ToyPlant;
use firmware_sim::qemu::{Board, Device, Link};
use firmware_sim::remote::{Connection, RemoteError, flash};
use firmware_sim::rollout::fly_episode;
use rustix::process::{Pid, Signal, kill_process};
use ted_policy::{Artifact, ArtifactBytes};

use super::{artefacts, boards};

/// How often the plug is pulled, from the first byte to after the last answer.
const CUTS: u32 = 20;

fn checksum(artefact: &[u8]) -> u32 {
    let bytes = ArtifactBytes::from_vec(artefact.to_vec());
    Artifact::parse(&bytes).unwrap().checksum()
}

fn flying(connection: &Connection<Device>) -> Option<u32> {
    connection.hello().slots.iter().find_map(|slot| match slot {
        SlotReport::Active { checksum } => Some(*checksum),
        _ => None,
    })
}

#[test]
fn what_flew_before_flies_on_when_the_plug_is_pulled_in_the_middle_of_an_artefact() {
    let folder = tempfile::tempdir().unwrap();
    let image = folder.path().join("flash");
    let fleet = boards::fleet(Board::An386, Link::Fifo, Some(&image));
    let (old, new) = (artefacts::toy(), artefacts::other_toy());
    drop(boards::with(&fleet, &old));

    let chunks: Vec<_> = new.chunks(256).collect();
    for sent in 0..=chunks.len() {
        let mut connection = fleet.connect().unwrap();
        let begin = FlashBegin {
            length: new.len() as u32,
            checksum: checksum(&new),
            accept_other_contract: false,
        };
        connection
            .ask("announce", &Request::FlashBegin(begin))
            .unwrap();
        for (index, &bytes) in chunks.iter().enumerate().take(sent) {
            let offset = 256 * index as u32;
            connection
                .ask("send", &Request::FlashData { offset, bytes })
                .unwrap();
        }
        connection.stream().kill();
        let error = connection.greet();
        assert!(matches!(error, Err(RemoteError::NoLink(_))), "{error:?}");
        drop(connection);

        let connection = fleet.connect().unwrap();
        assert_eq!(flying(&connection), Some(checksum(&old)), "after {sent}");
        let mut pilot = boards::pilot(connection, Numeric::F32);
        let (episode, _) = fly_episode(&mut pilot, &mut ToyPlant::new(), 1).unwrap();
        assert!(episode.success);
    }

    let mut connection = fleet.connect().unwrap();
    flash(&mut connection, &new, false, |_| ()).unwrap();
    drop(connection);
    let connection = fleet.connect().unwrap();
    assert_eq!(flying(&connection), Some(checksum(&new)));
}

/// Sends an artefact and pulls the plug after `delay`, whatever the board does then; whether it had taken the artefact.
fn flash_until(connection: &mut Connection<Device>, artefact: &[u8], delay: Duration) -> bool {
    let process = Pid::from_raw(connection.stream().id() as i32).expect("it runs");
    thread::scope(|scope| {
        let plug = scope.spawn(move || {
            thread::sleep(delay);
            // Fails when the board is gone, which nothing but this ends.
            kill_process(process, Signal::KILL).expect("the plug is pulled");
        });
        let done = flash(connection, artefact, false, |_| ());
        plug.join().expect("it was pulled");
        done.is_ok()
    })
}

#[test]
fn a_plug_pulled_at_any_moment_leaves_the_old_policy_or_the_new_one() {
    let folder = tempfile::tempdir().unwrap();
    let image = folder.path().join("flash");
    let fleet = boards::fleet(Board::An386, Link::Fifo, Some(&image));
    let artefacts = [artefacts::large(), artefacts::other_large()];
    let checksums = artefacts.each_ref().map(|it| checksum(it));
    let mut connection = fleet.connect().unwrap();
    let began = Instant::now();
    flash(&mut connection, &artefacts[0], false, |_| ()).unwrap();
    let whole = began.elapsed();
    drop(connection);

    let mut flies = 0;
    for cut in 1..=CUTS {
        let mut connection = fleet.connect().unwrap();
        let next = 1 - flies;
        // Some of the last ones are late: the artefact is in service by then.
        let delay = whole * cut * 5 / (CUTS * 4);
        let taken = flash_until(&mut connection, &artefacts[next], delay);
        drop(connection);

        let flying = flying(&fleet.connect().unwrap());
        let found = checksums.iter().position(|it| Some(*it) == flying);
        let found = found.unwrap_or_else(|| panic!("cut {cut} left {flying:x?}"));
        assert!(!taken || found == next, "cut {cut} lost what was taken");
        flies = found;
    }
}

#[test]
fn a_file_of_flash_belongs_to_one_board_at_a_time() {
    let folder = tempfile::tempdir().unwrap();
    let image = folder.path().join("flash");
    let fleet = boards::fleet(Board::An386, Link::Fifo, Some(&image));
    let first = fleet.connect().unwrap();
    let second = fleet.connect();
    let words = second.map(|_| ()).unwrap_err().to_string();
    assert!(words.contains("another board runs from it"), "{words}");
    drop(first);
    fleet.connect().unwrap();
}

#[test]
fn a_file_that_is_no_flash_is_left_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let film = folder.path().join("film");
    for length in [1, (16 << 20) - 1, (16 << 20) + 1] {
        let bytes = vec![0x47; length];
        fs::write(&film, &bytes).unwrap();
        let fleet = boards::fleet(Board::An386, Link::Fifo, Some(&film));
        let words = fleet.connect().map(|_| ()).unwrap_err().to_string();
        assert!(words.contains("it is something else"), "{words}");
        assert!(fs::read(&film).unwrap() == bytes);
    }
}
