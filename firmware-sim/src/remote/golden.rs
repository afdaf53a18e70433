//! The golden frames of `docs/device-protocol.md`.

use std::collections::BTreeMap;

use ted_core::NEW_EPISODE;

use crate::controller::{Numeric, Status};
use crate::device::Counters;
use crate::device::frame::{self, MAX_FRAME};
use crate::device::message::{
    Acted, FlashBegin, Floats, Health, Hello, PROTOCOL_VERSION, Refusal, Reply, Request, Score,
    Start,
};
use crate::device::slots::SlotReport;
use crate::safety::{Action, Fault};

const DOCUMENT: &str = include_str!("../../../docs/device-protocol.md");

/// The frames of the document by name, in hexadecimal.
fn golden() -> BTreeMap<String, String> {
    let block = DOCUMENT
        .split("```golden\n")
        .nth(1)
        .and_then(|rest| rest.split("```").next());
    let mut frames: BTreeMap<String, String> = BTreeMap::new();
    let mut current = String::new();
    for line in block.expect("the document has golden frames").lines() {
        let digits = match line.split_once('=') {
            Some((name, digits)) => {
                current = name.trim().to_owned();
                digits
            }
            None => line,
        };
        let frame = frames.entry(current.clone()).or_default();
        frame.push_str(digits.trim());
    }
    frames
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn bytes(hexadecimal: &str) -> Vec<u8> {
    let pairs = hexadecimal.as_bytes().chunks(2);
    let byte = |pair| u8::from_str_radix(&String::from_utf8_lossy(pair), 16);
    pairs
        .map(|pair| byte(pair).expect("the document holds hexadecimal digits"))
        .collect()
}

fn framed(number: u16, message: &impl serde::Serialize) -> String {
    let mut buffer = [0; MAX_FRAME];
    let length = frame::build(&mut buffer, number, message).expect("it fits");
    hexadecimal(&buffer[..length])
}

const VALUES: [u8; 8] = [0, 0, 128, 62, 0, 0, 0, 64];

fn requests() -> Vec<(&'static str, u16, Request<'static>)> {
    let values = Floats::from_le_bytes(&VALUES).expect("two numbers");
    vec![
        (
            "hello",
            7,
            Request::Hello {
                protocol: 2,
                session: 7,
            },
        ),
        (
            "start",
            2,
            Request::Start(Start {
                numeric: Numeric::Integer,
                silence_us: 50_000,
            }),
        ),
        (
            "tick",
            3,
            Request::Tick {
                now_us: 12_500,
                sequence: 1,
                stamp_us: 12_000,
                values,
            },
        ),
        ("rearm", 4, Request::Rearm),
        (
            "flash-begin",
            5,
            Request::FlashBegin(FlashBegin {
                length: 320,
                checksum: 0x8533_24ec,
                accept_other_contract: true,
            }),
        ),
        (
            "flash-data",
            6,
            Request::FlashData {
                offset: 512,
                bytes: &[0, 1, 2, 0],
            },
        ),
        ("flash-commit", 7, Request::FlashCommit),
        ("health", 8, Request::Health),
        (
            "log",
            10,
            Request::Log {
                episode: NEW_EPISODE,
                observation: values,
                action: values,
            },
        ),
    ]
}

fn replies() -> Vec<(&'static str, u16, Reply<'static>)> {
    let acted = Acted {
        action: Action::from_slice(&[1.0, -0.5]).expect("it fits"),
        status: Status {
            tick: 4,
            fault: Some(Fault::Stale {
                stamp_us: 12_000,
                now_us: 50_000,
            }),
            clamped: false,
            slew_limited: true,
            deadline_missed: true,
            deadlines_missed: 2,
        },
        work: 370_000,
        score: Some(Score {
            return_hat: 61.5,
            top_k: true,
            work: 1_300_000,
        }),
    };
    vec![
        (
            "hello-reply",
            7,
            Reply::Hello(Hello {
                protocol: 2,
                session: 7,
                board: "mps2-an386",
                firmware: "0.1.0",
                active: Some(1),
                task: "reach-v3".into(),
                slots: [
                    SlotReport::Refused(Refusal::Checksum {
                        expected: 1,
                        actual: 2,
                    }),
                    SlotReport::Active {
                        checksum: 0x8533_24ec,
                    },
                ],
                slot_bytes: 2_093_056,
                work_hz: 25_000_000,
            }),
        ),
        ("done", 2, Reply::Done),
        ("acted", 3, Reply::Acted(acted.clone())),
        (
            "flashed",
            7,
            Reply::Flashed {
                slot: 1,
                checksum: 0x8533_24ec,
            },
        ),
        (
            "health-reply",
            8,
            Reply::Health(Health {
                counters: Counters {
                    crc_errors: 1,
                    too_long: 2,
                    malformed: 3,
                    duplicates: 4,
                    reordered: 5,
                    dropped: 6,
                    link_errors: 700,
                },
                stack_high_water: 4096,
            }),
        ),
        (
            "refused",
            9,
            Reply::Refused(Refusal::Offset { expected: 512 }),
        ),
        (
            "silent",
            3,
            Reply::Silent(Acted {
                status: Status {
                    fault: Some(Fault::LinkSilent { limit_us: 50_000 }),
                    ..acted.status
                },
                work: 0,
                score: None,
                ..acted
            }),
        ),
        (
            "scored",
            10,
            Reply::Scored(Score {
                return_hat: 61.5,
                top_k: true,
                work: 1_300_000,
            }),
        ),
    ]
}

#[test]
fn the_document_names_the_version_that_the_code_speaks() {
    let title = DOCUMENT.lines().next().expect("a title");
    assert!(
        title.ends_with(&format!("version {PROTOCOL_VERSION}")),
        "{title}"
    );
}

#[test]
fn all_messages_are_the_document_s() {
    let requests = requests()
        .into_iter()
        .map(|(name, number, request)| (name.to_owned(), framed(number, &request)));
    let replies = replies()
        .into_iter()
        .map(|(name, number, reply)| (name.to_owned(), framed(number, &reply)));
    let ours: BTreeMap<String, String> = requests.chain(replies).collect();
    assert_eq!(golden(), ours);
}

#[test]
fn the_document_s_frames_are_read_as_what_they_say() {
    let golden = golden();
    let open = |name: &str| {
        let mut stuffed = bytes(&golden[name]);
        assert_eq!(stuffed.pop(), Some(0));
        let body = frame::open(&mut stuffed).expect("a whole frame");
        (body.number, body.message.to_vec())
    };
    for (name, number, request) in requests() {
        let (found, message) = open(name);
        assert_eq!(
            (found, postcard::from_bytes(&message)),
            (number, Ok(request))
        );
    }
    for (name, number, reply) in replies() {
        let (found, message) = open(name);
        assert_eq!((found, postcard::from_bytes(&message)), (number, Ok(reply)));
    }
}

#[test]
fn any_flipped_bit_of_a_frame_is_noticed() {
    let golden = golden();
    let good = bytes(&golden["acted"]);
    for bit in 0..(good.len() - 1) * 8 {
        let mut bad = good.clone();
        bad.pop();
        bad[bit / 8] ^= 1 << (bit % 8);
        assert_eq!(frame::open(&mut bad), None, "bit {bit}");
    }
}

#[test]
fn codes_are_the_numbers_on_the_wire_plus_one() {
    let refusals = [
        Refusal::Malformed,
        Refusal::NoPolicy,
        Refusal::NotStarted,
        Refusal::NotAnnounced,
        Refusal::Offset { expected: 0 },
        Refusal::TooLarge { limit: 0 },
        Refusal::Flash,
        Refusal::Checksum {
            expected: 0,
            actual: 0,
        },
        Refusal::Defect { code: 0 },
        Refusal::Golden { case: 0 },
        Refusal::OtherContract,
        Refusal::CannotScore,
        Refusal::OtherShape,
        Refusal::CannotWatch,
        Refusal::Undeclared,
    ];
    for refusal in refusals {
        let wire = postcard::to_allocvec(&refusal).expect("it fits");
        assert_eq!(wire[0] + 1, refusal.code());
    }
    let (us, code) = (0, 0);
    let faults = [
        Fault::NotFinite { index: code },
        Fault::OutOfRange { index: code },
        Fault::WrongLength {
            expected: code,
            actual: code,
        },
        Fault::Stale {
            stamp_us: us,
            now_us: us,
        },
        Fault::OutOfSequence {
            expected: 0,
            actual: 0,
        },
        Fault::ActionNotFinite { index: code },
        Fault::DeadlineMissed { elapsed_us: us },
        Fault::ClockWentBack {
            last_us: us,
            now_us: us,
        },
        Fault::PolicyRefused,
        Fault::LinkSilent { limit_us: 0 },
    ];
    for fault in faults {
        let wire = postcard::to_allocvec(&fault).expect("it fits");
        assert_eq!(wire[0] + 1, fault.code());
    }
}

#[test]
fn every_defect_has_words() {
    for code in (1..=23).filter(|code| ![6, 21].contains(code)) {
        let words = Refusal::Defect { code }.to_string();
        assert!(!words.contains("does not know"), "{code}: {words}");
    }
    let unknown = Refusal::Defect { code: 200 }.to_string();
    assert!(unknown.contains("does not know"), "{unknown}");
}
