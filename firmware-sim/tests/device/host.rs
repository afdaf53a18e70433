//! The host against a device that is a script: what it believes, and what it does not.

use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};

use firmware_sim::device::frame::{self, MAX_FRAME};
use firmware_sim::device::message::{Hello, PROTOCOL_VERSION, Reply, Request};
use firmware_sim::device::slots::SlotReport;
use firmware_sim::remote::{Connection, LinkOptions, RemoteError, flash};

use super::artefacts::{QUICK, checksum, toy_artefact};

/// A device that answers each request as a function says, by number and message.
struct Puppet<F> {
    answer: F,
    heard: Vec<u8>,
    said: VecDeque<u8>,
}

fn puppet<F>(answer: F) -> Puppet<F>
where
    F: FnMut(u16, Request<'_>) -> Vec<(u16, Reply<'static>)>,
{
    Puppet {
        answer,
        heard: Vec::new(),
        said: VecDeque::new(),
    }
}

impl<F> Write for Puppet<F>
where
    F: FnMut(u16, Request<'_>) -> Vec<(u16, Reply<'static>)>,
{
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        for &byte in bytes {
            if byte != 0 {
                self.heard.push(byte);
                continue;
            }
            let mut stuffed = std::mem::take(&mut self.heard);
            let Some(body) = frame::open(&mut stuffed) else {
                continue;
            };
            let request = postcard::from_bytes(body.message).unwrap();
            for (number, reply) in (self.answer)(body.number, request) {
                let mut buffer = [0; MAX_FRAME];
                let length = frame::build(&mut buffer, number, &reply).unwrap();
                self.said.extend(&buffer[..length]);
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl<F> Read for Puppet<F> {
    fn read(&mut self, room: &mut [u8]) -> io::Result<usize> {
        match self.said.read(room)? {
            0 => Err(ErrorKind::TimedOut.into()),
            length => Ok(length),
        }
    }
}

fn greeting(session: u32, board: &'static str, slots: [SlotReport; 2]) -> Reply<'static> {
    Reply::Hello(Hello {
        protocol: PROTOCOL_VERSION,
        session,
        board,
        firmware: "",
        active: None,
        task: "".into(),
        slots,
        slot_bytes: 0,
        work_hz: 0,
    })
}

#[test]
fn an_old_host_s_reply_is_not_taken_for_an_own_one() {
    let options = LinkOptions {
        session: 0x0007_ffff,
        ..QUICK
    };
    let empty = [SlotReport::Empty; 2];
    let device = puppet(|number, request| {
        assert_eq!(number, 0xffff, "a session begins with its own number");
        let Request::Hello { session, .. } = request else {
            panic!("{request:?}");
        };
        // What the host before this one asked, under the same number, comes first.
        vec![
            (number, Reply::Done),
            (number, greeting(6, "old", empty)),
            (number, greeting(session, "new", empty)),
        ]
    });
    let connection = Connection::open(device, options).unwrap();
    assert_eq!(connection.hello().board, "new");
    assert_eq!(connection.errors().stale, 2);
}

#[test]
fn a_device_that_says_flashed_and_flies_another_artefact_is_not_believed() {
    let artefact = toy_artefact();
    let sent = checksum(&artefact);
    for (found, believed) in [(sent, true), (sent ^ 1, false)] {
        let device = puppet(|number, request| {
            let slots = [SlotReport::Empty, SlotReport::Active { checksum: found }];
            let reply = match request {
                Request::Hello { session, .. } => greeting(session, "puppet", slots),
                Request::FlashCommit => Reply::Flashed {
                    slot: 1,
                    checksum: sent,
                },
                _ => Reply::Done,
            };
            vec![(number, reply)]
        });
        let mut connection = Connection::open(device, QUICK).unwrap();
        let flashed = flash(&mut connection, &artefact, false, |_| {});
        match flashed {
            Ok(_) => assert!(believed),
            Err(error) => assert!(
                !believed && matches!(error, RemoteError::NotFlying),
                "{error}"
            ),
        }
    }
}
