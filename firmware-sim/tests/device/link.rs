//! The link, frame by frame: whatever comes in, a device answers what it was asked once, and goes on.

use std::convert::Infallible;

use embedded_io::{ErrorType, Read, ReadReady, Write};
use firmware_sim::bench::{HostBoard, MemoryFlash};
use firmware_sim::device::frame::{self, MAX_FRAME};
use firmware_sim::device::message::{
    Acted, Floats, Health, PROTOCOL_VERSION, Refusal, Reply, Request, Start,
};
use firmware_sim::device::{Counters, Receiver, serve};
use proptest::collection::vec;
use proptest::prelude::*;
use serde::Serialize;

use super::artefacts::{flash_with, toy_artefact};

const HELLO: Request<'_> = Request::Hello {
    protocol: PROTOCOL_VERSION,
    session: 9,
};
const FLY: Request<'_> = Request::Start(Start {
    numeric: firmware_sim::controller::Numeric::F32,
    silence_us: 0,
});

/// A link on which everything was said before the device starts, and that takes notes.
struct Script<'a> {
    bytes: &'a [u8],
    at_once: usize,
    said: &'a mut Vec<u8>,
}

impl ErrorType for Script<'_> {
    type Error = Infallible;
}

impl Read for Script<'_> {
    fn read(&mut self, room: &mut [u8]) -> Result<usize, Infallible> {
        let length = self.bytes.len().min(room.len()).min(self.at_once);
        let (now, later) = self.bytes.split_at(length);
        room[..length].copy_from_slice(now);
        self.bytes = later;
        Ok(length)
    }
}

impl ReadReady for Script<'_> {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        Ok(true)
    }
}

impl Write for Script<'_> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        let length = bytes.len().min(self.at_once);
        self.said.extend(&bytes[..length]);
        Ok(length)
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

fn framed(number: u16, message: &impl Serialize) -> Vec<u8> {
    let mut buffer = vec![0; MAX_FRAME];
    let length = frame::build(&mut buffer, number, message).unwrap();
    buffer.truncate(length);
    buffer
}

/// Everything that a device with the toy's policy says to these bytes.
fn said_by(memory: &mut MemoryFlash, bytes: &[u8], at_once: usize) -> Vec<u8> {
    let mut said = Vec::new();
    let script = Script {
        bytes,
        at_once,
        said: &mut said,
    };
    serve(script, memory, &mut HostBoard::new());
    said
}

/// The replies in these bytes, each with its number; all of it is whole frames.
fn replies(said: &[u8]) -> Vec<(u16, Vec<u8>)> {
    let frames = said.split_inclusive(|byte| *byte == 0);
    let open = |frame: &[u8]| {
        let mut stuffed = frame[..frame.len() - 1].to_vec();
        let body = frame::open(&mut stuffed).unwrap();
        (body.number, body.message.to_vec())
    };
    frames.map(open).collect()
}

/// What a device says to these frames.
fn answers(frames: &[Vec<u8>]) -> Vec<(u16, Vec<u8>)> {
    let mut memory = flash_with(&[&toy_artefact()]);
    replies(&said_by(&mut memory, &frames.concat(), usize::MAX))
}

fn reply(message: &[u8]) -> Reply<'_> {
    postcard::from_bytes(message).unwrap()
}

fn refusal(message: &[u8]) -> Refusal {
    match reply(message) {
        Reply::Refused(refusal) => refusal,
        other => panic!("{other:?}"),
    }
}

fn counters(message: &[u8]) -> Counters {
    match reply(message) {
        Reply::Health(Health { counters, .. }) => counters,
        other => panic!("{other:?}"),
    }
}

fn floats(values: &[f32]) -> Vec<u8> {
    values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect()
}

fn tick(sequence: u32, values: &[u8]) -> Request<'_> {
    let now_us = u64::from(sequence) * 10_000;
    Request::Tick {
        now_us,
        sequence,
        stamp_us: now_us,
        values: Floats::from_le_bytes(values).unwrap(),
    }
}

#[test]
fn a_request_that_comes_twice_is_done_once_and_answered_twice() {
    let values = floats(&[0.1, 0.2, 0.3, 0.4, 0.0]);
    let once = framed(3, &tick(0, &values));
    let answers = answers(&[
        framed(1, &HELLO),
        framed(2, &FLY),
        once.clone(),
        once.clone(),
        once,
        framed(4, &tick(1, &values)),
        framed(5, &Request::Health),
    ]);
    let numbers: Vec<u16> = answers.iter().map(|(number, _)| *number).collect();
    assert_eq!(numbers, [1, 2, 3, 3, 3, 4, 5]);
    assert_eq!(answers[2], answers[3]);
    assert_eq!(answers[2], answers[4]);
    let Reply::Acted(Acted { status, .. }) = reply(&answers[5].1) else {
        panic!("a tick is answered with an action");
    };
    assert_eq!((status.tick, status.fault), (1, None));
    assert_eq!(counters(&answers[6].1).duplicates, 2);
}

#[test]
fn an_older_request_is_dropped_and_a_missing_one_is_counted() {
    let answers = answers(&[
        framed(65_534, &HELLO),
        framed(65_535, &Request::Health),
        framed(2, &Request::Health),
        framed(0, &FLY),
        framed(3, &Request::Health),
    ]);
    let numbers: Vec<u16> = answers.iter().map(|(number, _)| *number).collect();
    assert_eq!(numbers, [65_534, 65_535, 2, 3]);
    let counters = counters(&answers[3].1);
    assert_eq!((counters.dropped, counters.reordered), (2, 1));
}

#[test]
fn a_new_host_may_number_as_it_likes_and_an_old_greeting_changes_nothing() {
    let other_host = Request::Hello {
        protocol: PROTOCOL_VERSION,
        session: 10,
    };
    let answers = answers(&[
        framed(500, &HELLO),
        framed(501, &Request::Health),
        framed(500, &HELLO),
        framed(1, &other_host),
        framed(2, &FLY),
        // An echo of the session before, and one of this session, which must not be acted on twice.
        framed(500, &HELLO),
        framed(2, &FLY),
        framed(3, &Request::Health),
    ]);
    let numbers: Vec<u16> = answers.iter().map(|(number, _)| *number).collect();
    assert_eq!(numbers, [500, 501, 1, 2, 2, 3]);
    let counters = counters(&answers[5].1);
    assert_eq!((counters.reordered, counters.duplicates), (2, 1));
}

#[test]
fn a_host_of_another_version_is_greeted_like_any_other() {
    let future = Request::Hello {
        protocol: 999,
        session: 1,
    };
    let with_more_fields = (future, "of which nothing is known", [1_u8; 30]);
    let answers = answers(&[
        framed(1, &HELLO),
        framed(7, &future),
        framed(9, &with_more_fields),
        framed(2, &Request::Health),
    ]);
    let numbers: Vec<u16> = answers.iter().map(|(number, _)| *number).collect();
    assert_eq!(numbers, [1, 7, 9, 2]);
    for (_, message) in &answers[1..3] {
        let (kind, version): (u8, u16) = postcard::take_from_bytes(message).unwrap().0;
        assert_eq!((kind, version), (0, PROTOCOL_VERSION));
    }
    let expected = Counters::default();
    assert_eq!(counters(&answers[3].1), expected, "nothing came of it");
}

#[test]
fn a_message_of_no_known_kind_is_refused_and_the_next_one_is_not() {
    let values = floats(&[0.0; 5]);
    let with_more_behind = (tick(0, &values), 7_u8);
    let answers = answers(&[
        framed(1, &HELLO),
        framed(2, &99_u8),
        framed(3, &with_more_behind),
        framed(4, &Raw(Vec::new())),
        framed(5, &Request::Health),
    ]);
    for (_, message) in &answers[1..4] {
        assert_eq!(refusal(message), Refusal::Malformed);
    }
    assert_eq!(counters(&answers[4].1).malformed, 3);
}

#[test]
fn what_is_asked_out_of_turn_is_refused_by_name() {
    let values = floats(&[0.0; 5]);
    let data = Request::FlashData {
        offset: 0,
        bytes: &[0; 4],
    };
    let answers = answers(&[
        framed(1, &tick(0, &values)),
        framed(2, &Request::Rearm),
        framed(3, &data),
        framed(4, &Request::FlashCommit),
        framed(5, &FLY),
        framed(6, &data),
    ]);
    let refusals: Vec<Refusal> = answers
        .iter()
        .filter(|(number, _)| *number != 5)
        .map(|(_, message)| refusal(message))
        .collect();
    use Refusal::{NotAnnounced, NotStarted};
    assert_eq!(
        refusals,
        [
            NotStarted,
            NotStarted,
            NotAnnounced,
            NotAnnounced,
            NotAnnounced
        ]
    );
}

#[test]
fn an_observation_that_no_contract_has_room_for_is_refused() {
    let too_many = floats(&[0.0; 65]);
    let values = floats(&[0.0; 5]);
    let answers = answers(&[
        framed(1, &FLY),
        framed(2, &tick(0, &too_many)),
        framed(3, &tick(0, &values)),
    ]);
    assert_eq!(refusal(&answers[1].1), Refusal::Malformed);
    assert!(matches!(reply(&answers[2].1), Reply::Acted(acted) if acted.status.fault.is_none()));
}

#[test]
fn the_largest_messages_fit_their_frames() {
    let values = floats(&[f32::MAX; 64]);
    let largest_tick = Request::Tick {
        now_us: u64::MAX,
        sequence: u32::MAX,
        stamp_us: u64::MAX,
        values: Floats::from_le_bytes(&values).unwrap(),
    };
    let largest_data = Request::FlashData {
        offset: u32::MAX,
        bytes: &[0; frame::CHUNK_LENGTH],
    };
    for request in [largest_tick, largest_data] {
        assert!(framed(u16::MAX, &request).len() <= MAX_FRAME);
    }
}

#[test]
fn the_largest_replies_fit_their_frames() {
    use firmware_sim::controller::Status;
    use firmware_sim::device::frame::{MAX_REPLY, NAME_LENGTH};
    use firmware_sim::device::message::{Hello, Score};
    use firmware_sim::device::slots::SlotReport;
    use firmware_sim::safety::{Action, Fault};

    let long = "x".repeat(NAME_LENGTH);
    let slot = SlotReport::Refused(Refusal::Checksum {
        expected: u32::MAX,
        actual: u32::MAX,
    });
    let hello = Reply::Hello(Hello {
        protocol: u16::MAX,
        session: u32::MAX,
        board: &long,
        firmware: &long,
        active: Some(u8::MAX),
        task: long.as_str().into(),
        slots: [slot; 2],
        slot_bytes: u32::MAX,
        work_hz: u32::MAX,
    });
    let acted = Reply::Acted(Acted {
        action: Action::from_slice(&[f32::MAX; 16]).unwrap(),
        status: Status {
            tick: u32::MAX,
            fault: Some(Fault::Stale {
                stamp_us: u64::MAX,
                now_us: u64::MAX,
            }),
            clamped: true,
            slew_limited: true,
            deadline_missed: true,
            deadlines_missed: u32::MAX,
        },
        work: u32::MAX,
        score: Some(Score {
            return_hat: f32::MAX,
            top_k: true,
            work: u32::MAX,
        }),
    });
    for reply in [hello, acted] {
        let message = postcard::to_extend(&reply, Vec::new()).unwrap();
        assert!(message.len() <= MAX_REPLY, "{} bytes", message.len());
    }
}

proptest! {
    #[test]
    fn any_bytes_into_the_receiver_are_taken_without_a_panic(
        bytes in vec(prop_oneof![Just(0), any::<u8>()], 0..3000),
        at_once in 1..700_usize,
    ) {
        let (mut receiver, mut counters) = (Receiver::<64>::new(), Counters::default());
        for mut chunk in bytes.chunks(at_once) {
            while !chunk.is_empty() {
                let room = receiver.room(&mut counters);
                prop_assert!(!room.is_empty());
                let length = room.len().min(chunk.len());
                room[..length].copy_from_slice(&chunk[..length]);
                receiver.received(length);
                chunk = &chunk[length..];
                while receiver.advance(&mut counters) {}
            }
        }
    }

    #[test]
    fn frames_are_found_wherever_the_reads_are_cut(
        messages in vec((any::<u16>(), vec(any::<u8>(), 0..40), 0..3_usize), 0..20),
        at_once in 1..90_usize,
    ) {
        let mut bytes = Vec::new();
        for (number, message, zeros) in &messages {
            bytes.resize(bytes.len() + zeros, 0);
            bytes.extend(framed(*number, message));
        }
        let (mut receiver, mut counters) = (Receiver::<96>::new(), Counters::default());
        let mut found = Vec::new();
        for mut chunk in bytes.chunks(at_once) {
            while !chunk.is_empty() {
                let room = receiver.room(&mut counters);
                let length = room.len().min(chunk.len());
                room[..length].copy_from_slice(&chunk[..length]);
                receiver.received(length);
                chunk = &chunk[length..];
                while receiver.advance(&mut counters) {
                    let body = receiver.body();
                    found.push((body.number, postcard::from_bytes::<Vec<u8>>(body.message).unwrap()));
                }
            }
        }
        let sent: Vec<_> = messages.into_iter().map(|(number, message, _)| (number, message)).collect();
        prop_assert_eq!(found, sent);
        prop_assert_eq!(counters, Counters::default());
    }

    #[test]
    fn whatever_comes_in_only_whole_replies_go_out_and_the_policy_stays(
        parts in vec(
            prop_oneof![
                vec(any::<u8>(), 0..300),
                (any::<u16>(), vec(any::<u8>(), 0..60)).prop_map(|(number, message)| {
                    let mut buffer = vec![0; MAX_FRAME];
                    let length = frame::build(&mut buffer, number, &Raw(message)).unwrap();
                    buffer.truncate(length);
                    buffer
                }),
            ],
            0..12,
        ),
        at_once in 1..600_usize,
    ) {
        let toy = toy_artefact();
        let mut memory = flash_with(&[&toy]);
        let said = said_by(&mut memory, &parts.concat(), at_once);
        for (_, message) in replies(&said) {
            prop_assert!(postcard::from_bytes::<Reply<'_>>(&message).is_ok());
        }
        let found = firmware_sim::device::slots::survey(&memory);
        prop_assert_eq!(found.active.unwrap().bytes(&memory), &toy[..]);
    }
}

/// A message that is these bytes and nothing else.
#[derive(Debug)]
struct Raw(Vec<u8>);

impl Serialize for Raw {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        use serde::ser::SerializeTuple;
        let mut tuple = serializer.serialize_tuple(self.0.len())?;
        for byte in &self.0 {
            tuple.serialize_element(byte)?;
        }
        tuple.end()
    }
}
