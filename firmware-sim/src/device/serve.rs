//! The loop of a device: rest, fly, take an artefact, whichever the host asks for.

use embedded_io::{Read, ReadReady, Write};
use ted_policy::Text;

use super::fly::fly;
use super::frame::NAME_LENGTH;
use super::line::{Event, Line};
use super::message::{FlashBegin, Health, Hello, PROTOCOL_VERSION, Refusal, Reply, Request, Start};
use super::receive_artefact::receive_artefact;
use super::slots::{self, Layout, Survey};
use super::{Board, MappedFlash};

/// The other end of the link is gone for good: its `read` gave nothing. A serial port never says so.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LinkClosed;

const FIRMWARE: &str = env!("CARGO_PKG_VERSION");

/// What a device does next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Next {
    /// Find out which slot flies.
    Survey,
    /// Wait for an episode or an artefact.
    Rest,
    /// Answer this request by flying an episode.
    Fly(Start),
    /// Answer this request by taking an artefact.
    Receive(FlashBegin),
    /// Nothing: the link is closed.
    Stop,
}

/// Serves a host over `link` for as long as there is one.
///
/// The flash is only borrowed for reading while a policy flies from it, and only written while none does. So an episode
/// ends where an artefact begins.
pub fn serve<L, F, B>(link: L, flash: &mut F, board: &mut B) -> LinkClosed
where
    L: Read + ReadReady + Write,
    F: MappedFlash,
    B: Board,
{
    let mut line = Line::new(link);
    let mut survey = Survey::default();
    let mut next = Next::Survey;
    loop {
        next = match next {
            Next::Survey => {
                survey = slots::survey(flash);
                Next::Rest
            }
            Next::Rest => rest(&mut line, flash, board, &survey),
            Next::Fly(start) => fly(&mut line, flash, board, &survey, start),
            Next::Receive(announced) => {
                receive_artefact(&mut line, flash, board, &mut survey, announced)
            }
            Next::Stop => return LinkClosed,
        };
    }
}

fn rest<L, F, B>(line: &mut Line<L>, flash: &F, board: &mut B, survey: &Survey) -> Next
where
    L: Read + ReadReady + Write,
    F: MappedFlash,
    B: Board,
{
    loop {
        match line.wait(board, None) {
            Event::Closed => return Next::Stop,
            Event::Silence => {}
            Event::Request => match line.request() {
                Request::Start(start) => return Next::Fly(start),
                Request::FlashBegin(announced) => return Next::Receive(announced),
                _ => answer(line, flash, board, survey),
            },
        }
    }
}

/// Answers the request at hand, which the present phase has no other answer to.
#[inline(never)]
pub(super) fn answer<L, F, B>(line: &mut Line<L>, flash: &F, board: &mut B, survey: &Survey)
where
    L: Read + ReadReady + Write,
    F: MappedFlash,
    B: Board,
{
    // A greeting that does not fit its frame would never be answered.
    const {
        assert!(B::NAME.len() <= NAME_LENGTH && FIRMWARE.len() <= NAME_LENGTH);
    }
    let active = survey.active.as_ref();
    let reply = match line.request() {
        Request::Hello { session, .. } => {
            return line.greet(Reply::Hello(Hello {
                protocol: PROTOCOL_VERSION,
                session,
                board: B::NAME,
                firmware: FIRMWARE,
                active: active.map(|active| active.slot),
                task: active
                    .and_then(|active| Text::new(&active.task))
                    .unwrap_or_default(),
                slots: survey.slots,
                slot_bytes: Layout::of(flash).room(),
                work_hz: B::WORK_HZ,
            }));
        }
        Request::Health => Reply::Health(Health {
            counters: line.counters,
            stack_high_water: board.stack_high_water(),
        }),
        Request::FlashData { .. } | Request::FlashCommit | Request::FlashBegin(_) => {
            Reply::Refused(Refusal::NotAnnounced)
        }
        Request::Tick { .. } | Request::Log { .. } | Request::Rearm | Request::Start(_) => {
            match active {
                Some(_) => Reply::Refused(Refusal::NotStarted),
                None => Reply::Refused(Refusal::NoPolicy),
            }
        }
    };
    line.reply(reply);
}
