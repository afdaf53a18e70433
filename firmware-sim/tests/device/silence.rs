//! A link that falls silent, on a clock that the test turns.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::convert::Infallible;
use std::rc::Rc;

use embedded_io::{ErrorType, Read, ReadReady, Write};
use firmware_sim::bench::MemoryFlash;
use firmware_sim::controller::Numeric;
use firmware_sim::device::message::{Acted, FlashBegin, Floats, Refusal, Reply, Request, Start};
use firmware_sim::device::{Board, frame, serve};
use firmware_sim::safety::Fault;

use super::artefacts::{artefact_without_integers, flash_with, toy_artefact};

const LIMIT_US: u32 = 30_000;

/// What happens next: bytes come, or time goes by without any.
enum Event {
    Frame(Vec<u8>),
    Quiet(u64),
}

/// The world of a device: what happens to it, and what it says.
#[derive(Default)]
struct World {
    events: VecDeque<Event>,
    now_us: u64,
    said: Vec<u8>,
    /// How long it takes from one look at the work counter to the next.
    work_us: u64,
    /// How long it takes to read.
    read_us: u64,
    /// Whether its link cannot say that there is nothing to read.
    waits_in_read: bool,
}

/// The device's link and its board, which are two views of one world.
#[derive(Clone, Default)]
struct Stage(Rc<RefCell<World>>);

impl ErrorType for Stage {
    type Error = Infallible;
}

impl Read for Stage {
    fn read(&mut self, room: &mut [u8]) -> Result<usize, Infallible> {
        let mut world = self.0.borrow_mut();
        world.now_us += world.read_us;
        match world.events.pop_front() {
            Some(Event::Frame(frame)) => {
                room[..frame.len()].copy_from_slice(&frame);
                Ok(frame.len())
            }
            _ => Ok(0),
        }
    }
}

impl ReadReady for Stage {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        Ok(!matches!(
            self.0.borrow().events.front(),
            Some(Event::Quiet(_))
        ))
    }
}

impl Write for Stage {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        self.0.borrow_mut().said.extend(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

impl Board for Stage {
    const NAME: &'static str = "stage";
    const WORK_HZ: u32 = 0;

    fn now_us(&mut self) -> u64 {
        self.0.borrow().now_us
    }

    fn work(&mut self) -> u32 {
        let mut world = self.0.borrow_mut();
        world.now_us += world.work_us;
        0
    }

    fn notices_silence(&self) -> bool {
        !self.0.borrow().waits_in_read
    }

    fn stack_high_water(&mut self) -> u32 {
        0
    }

    /// A microsecond of quiet goes by.
    fn idle(&mut self) {
        let mut world = self.0.borrow_mut();
        world.now_us += 1;
        if let Some(Event::Quiet(left_us)) = world.events.front_mut() {
            *left_us -= 1;
            if *left_us == 0 {
                world.events.pop_front();
            }
        }
    }
}

fn request(number: u16, request: &Request<'_>) -> Event {
    let mut buffer = [0; 600];
    let length = frame::build(&mut buffer, number, request).unwrap();
    Event::Frame(buffer[..length].to_vec())
}

fn start(number: u16) -> Event {
    let start = Start {
        numeric: Numeric::F32,
        silence_us: LIMIT_US,
    };
    request(number, &Request::Start(start))
}

fn tick(number: u16, sequence: u32) -> Event {
    let values = [-0.5_f32, 0.25, 0.125, -0.75, 0.3];
    let bytes: Vec<u8> = values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    let now_us = u64::from(sequence) * 10_000;
    let tick = Request::Tick {
        now_us,
        sequence,
        stamp_us: now_us,
        values: Floats::from_le_bytes(&bytes).unwrap(),
    };
    request(number, &tick)
}

/// What a device says to that: the number and the message of each reply.
fn said_to(events: Vec<Event>) -> Vec<(u16, Vec<u8>)> {
    said_by_a_slow_device(0, events)
}

/// The same by a device that takes so long from one look at its work counter to the next.
fn said_by_a_slow_device(work_us: u64, events: Vec<Event>) -> Vec<(u16, Vec<u8>)> {
    said_with(&mut flash_with(&[&toy_artefact()]), work_us, events)
}

/// The same by a device for which a third of the time is over whenever it has read something.
fn said_with_slow_reading(events: Vec<Event>) -> Vec<(u16, Vec<u8>)> {
    let stage = Stage::default();
    stage.0.borrow_mut().read_us = u64::from(LIMIT_US) / 3;
    played(stage, &mut flash_with(&[&toy_artefact()]), events)
}

fn said_with(memory: &mut MemoryFlash, work_us: u64, events: Vec<Event>) -> Vec<(u16, Vec<u8>)> {
    let stage = Stage::default();
    stage.0.borrow_mut().work_us = work_us;
    played(stage, memory, events)
}

fn played(stage: Stage, memory: &mut MemoryFlash, events: Vec<Event>) -> Vec<(u16, Vec<u8>)> {
    stage.0.borrow_mut().events = events.into();
    serve(stage.clone(), memory, &mut stage.clone());
    let said = stage.0.borrow().said.clone();
    said.split_inclusive(|byte| *byte == 0)
        .map(|frame| {
            let mut stuffed = frame[..frame.len() - 1].to_vec();
            let body = frame::open(&mut stuffed).unwrap();
            (body.number, body.message.to_vec())
        })
        .collect()
}

fn acted(message: &[u8]) -> Acted {
    match postcard::from_bytes(message).unwrap() {
        Reply::Acted(acted) => acted,
        other => panic!("{other:?}"),
    }
}

fn silent(message: &[u8]) -> Acted {
    match postcard::from_bytes(message).unwrap() {
        Reply::Silent(acted) => acted,
        other => panic!("{other:?}"),
    }
}

fn numbers(said: &[(u16, Vec<u8>)]) -> Vec<u16> {
    said.iter().map(|(number, _)| *number).collect()
}

#[test]
fn a_silent_link_stops_the_plant_once_and_rearming_flies_on() {
    let said = said_to(vec![
        start(1),
        tick(2, 0),
        Event::Quiet(u64::from(LIMIT_US) * 5),
        tick(3, 1),
        request(4, &Request::Rearm),
        tick(5, 2),
    ]);
    assert_eq!(numbers(&said), [1, 2, 2, 3, 4, 5]);
    let fault = Some(Fault::LinkSilent { limit_us: LIMIT_US });
    let (flown, stopped) = (acted(&said[1].1), silent(&said[2].1));
    assert_eq!((stopped.status.tick, stopped.status.fault), (1, fault));
    assert_eq!(stopped.action[..2], [0.0; 2], "it moves no more");
    assert_eq!(stopped.action[2], flown.action[2], "and holds what it held");
    assert_eq!(
        acted(&said[3].1).status.fault,
        fault,
        "until someone decides"
    );
    assert_eq!(acted(&said[5].1).status.fault, None);
}

#[test]
fn a_tick_that_is_asked_again_after_the_silence_is_answered_with_the_stop() {
    let said = said_to(vec![
        start(1),
        tick(2, 0),
        Event::Quiet(u64::from(LIMIT_US) + 1),
        tick(2, 0),
    ]);
    assert_eq!(numbers(&said), [1, 2, 2, 2]);
    assert_eq!(silent(&said[2].1), silent(&said[3].1));
}

#[test]
fn another_answer_is_kept_through_a_silence() {
    let health = || request(3, &Request::Health);
    let said = said_to(vec![
        start(1),
        tick(2, 0),
        health(),
        Event::Quiet(u64::from(LIMIT_US) + 1),
        health(),
    ]);
    assert_eq!(numbers(&said), [1, 2, 3, 2, 3]);
    silent(&said[3].1);
    assert_eq!(said[2], said[4]);
}

#[test]
fn nobody_is_missed_before_the_first_tick_or_after_a_stop() {
    let pause = || Event::Quiet(u64::from(LIMIT_US) * 3);
    let said = said_to(vec![
        start(1),
        pause(),
        tick(2, 0),
        pause(),
        request(3, &Request::Rearm),
        pause(),
        tick(4, 1),
    ]);
    assert_eq!(numbers(&said), [1, 2, 2, 3, 4]);
    assert_eq!(acted(&said[4].1).status.fault, None);
}

#[test]
fn a_host_that_dies_after_rearming_a_healthy_flight_is_missed() {
    let almost = || Event::Quiet(u64::from(LIMIT_US) - 1);
    let said = said_to(vec![
        start(1),
        tick(2, 0),
        almost(),
        request(3, &Request::Rearm),
        almost(),
        request(4, &Request::Rearm),
        Event::Quiet(u64::from(LIMIT_US) + 1),
    ]);
    assert_eq!(
        numbers(&said),
        [1, 2, 3, 4, 2],
        "rearming begins the time anew"
    );
    assert_eq!(silent(&said[4].1).action[..2], [0.0; 2]);
}

#[test]
fn ticks_that_are_refused_are_no_sign_of_a_host() {
    let too_many = [0; 4 * 65];
    let refused = |number| {
        let values = Floats::from_le_bytes(&too_many).unwrap();
        let tick = Request::Tick {
            now_us: 0,
            sequence: 1,
            stamp_us: 0,
            values,
        };
        request(number, &tick)
    };
    let mut events = vec![start(1), tick(2, 0)];
    for number in 3..6 {
        events.extend([Event::Quiet(u64::from(LIMIT_US) / 2), refused(number)]);
    }
    let said = said_to(events);
    assert_eq!(numbers(&said), [1, 2, 3, 4, 2, 5]);
    silent(&said[4].1);
}

#[test]
fn whatever_ends_a_flight_stops_the_plant_first() {
    let announced = FlashBegin {
        length: 512,
        checksum: 0,
        accept_other_contract: false,
    };
    let in_integers = Start {
        numeric: Numeric::Integer,
        silence_us: LIMIT_US,
    };
    let enders = [
        request(3, &Request::FlashBegin(announced)),
        request(3, &Request::Start(in_integers)),
        start(3),
    ];
    for ender in enders {
        let said = said_to(vec![start(1), tick(2, 0), ender]);
        assert_eq!(numbers(&said), [1, 2, 2, 3]);
        let stopped = silent(&said[2].1);
        assert_eq!(stopped.action[..2], [0.0; 2], "it moves no more");
        assert_eq!(
            postcard::from_bytes::<Reply<'_>>(&said[3].1).unwrap(),
            Reply::Done
        );
    }
}

#[test]
fn what_is_refused_ends_no_flight() {
    let too_large = FlashBegin {
        length: u32::MAX,
        checksum: 0,
        accept_other_contract: false,
    };
    let in_integers = Start {
        numeric: Numeric::Integer,
        silence_us: LIMIT_US,
    };
    let enders = [
        request(3, &Request::FlashBegin(too_large)),
        request(3, &Request::Start(in_integers)),
    ];
    for ender in enders {
        let mut memory = flash_with(&[&artefact_without_integers()]);
        let events = vec![start(1), tick(2, 0), ender, tick(4, 1)];
        let said = said_with(&mut memory, 0, events);
        assert_eq!(numbers(&said), [1, 2, 3, 4]);
        let refused = postcard::from_bytes::<Reply<'_>>(&said[2].1).unwrap();
        assert!(matches!(refused, Reply::Refused(_)), "{refused:?}");
        assert_eq!(acted(&said[3].1).status.fault, None);
    }
}

#[test]
fn the_device_s_own_computing_is_no_silence() {
    let late = u64::from(LIMIT_US) * 2;
    let said = said_by_a_slow_device(late, vec![start(1), tick(2, 0), tick(3, 1), tick(4, 2)]);
    assert_eq!(numbers(&said), [1, 2, 3, 4]);
    for (_, message) in &said[1..] {
        assert_eq!(acted(message).status.fault, None);
    }
}

#[test]
fn bytes_that_came_in_time_are_read_before_silence_is_declared() {
    let quiet = || Event::Quiet(u64::from(LIMIT_US) - 1);
    let mut events = vec![start(1), tick(2, 0), quiet()];
    // The device looks at its clock when the time is over; the tick came long before.
    let Event::Frame(frame) = tick(3, 1) else {
        unreachable!("a request is a frame");
    };
    events.extend(frame.chunks(7).map(|part| Event::Frame(part.to_vec())));
    events.push(tick(4, 2));
    let said = said_with_slow_reading(events);
    assert_eq!(numbers(&said), [1, 2, 3, 4]);
}

#[test]
fn a_line_that_never_rests_is_silent_all_the_same() {
    let mut events = vec![start(1), tick(2, 0)];
    events.extend((0..3000).map(|_| Event::Frame(vec![7])));
    let said = said_with_slow_reading(events);
    assert_eq!(numbers(&said), [1, 2, 2]);
    silent(&said[2].1);
}

#[test]
fn ticks_that_keep_coming_are_never_silence() {
    let quiet = || Event::Quiet(u64::from(LIMIT_US) - 1);
    let said = said_to(vec![
        start(1),
        tick(2, 0),
        quiet(),
        tick(3, 1),
        quiet(),
        tick(4, 2),
    ]);
    assert_eq!(numbers(&said), [1, 2, 3, 4]);
}

#[test]
fn with_a_silence_of_zero_time_stands_still() {
    let said = said_to(vec![
        request(1, &Request::Start(Start::default())),
        tick(2, 0),
        Event::Quiet(1_000_000),
        tick(3, 1),
    ]);
    assert_eq!(numbers(&said), [1, 2, 3]);
}

#[test]
fn a_link_that_cannot_notice_silence_flies_in_lockstep_only() {
    let stage = Stage::default();
    stage.0.borrow_mut().waits_in_read = true;
    let lockstep = request(2, &Request::Start(Start::default()));
    let events = vec![start(1), lockstep, tick(3, 0), start(4), tick(5, 1)];
    let said = played(stage, &mut flash_with(&[&toy_artefact()]), events);
    assert_eq!(numbers(&said), [1, 2, 3, 4, 5]);
    for refused in [&said[0].1, &said[3].1] {
        assert_eq!(
            postcard::from_bytes::<Reply<'_>>(refused).unwrap(),
            Reply::Refused(Refusal::CannotWatch)
        );
    }
    assert_eq!(acted(&said[4].1).status.fault, None);
}
