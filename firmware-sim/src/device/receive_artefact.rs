//! Taking an artefact into the slot that does not fly.

use embedded_io::{Read, ReadReady, Write};

use super::line::{Event, Line};
use super::message::{FlashBegin, Refusal, Reply, Request};
use super::serve::{Next, answer};
use super::slots::{self, Active, SlotReport, Survey, Transfer};
use super::{Board, MappedFlash};

fn flies(survey: &Survey, fresh: &Active) -> bool {
    let active = survey.active.as_ref();
    active.is_some_and(|active| (active.slot, active.checksum) == (fresh.slot, fresh.checksum))
}

/// Answers a [`Request::FlashBegin`] and what follows it, until the artefact is judged or the host wants something else.
#[inline(never)]
pub(super) fn receive_artefact<L, F, B>(
    line: &mut Line<L>,
    flash: &mut F,
    board: &mut B,
    survey: &mut Survey,
    announced: FlashBegin,
) -> Next
where
    L: Read + ReadReady + Write,
    F: MappedFlash,
    B: Board,
{
    let mut transfer = match Transfer::begin(flash, survey, announced) {
        Ok(transfer) => transfer,
        Err(refusal) => {
            line.reply(Reply::Refused(refusal));
            return Next::Survey;
        }
    };
    let slot = usize::from(survey.inactive());
    if let Some(report) = survey.slots.get_mut(slot) {
        *report = SlotReport::Empty;
    }
    line.reply(Reply::Done);
    loop {
        match line.wait(board, None) {
            Event::Closed => return Next::Stop,
            Event::Silence => {}
            Event::Request => match line.request() {
                Request::FlashData { offset, bytes } => {
                    let reply = match transfer.write(flash, offset, bytes) {
                        Ok(()) => Reply::Done,
                        Err(refusal) => Reply::Refused(refusal),
                    };
                    line.reply(reply);
                }
                Request::FlashCommit => {
                    let taken = transfer.commit(flash, survey);
                    // What flies is what a device finds that is switched on now.
                    *survey = slots::survey(flash);
                    let reply = match taken {
                        Ok(fresh) if flies(survey, &fresh) => Reply::Flashed {
                            slot: fresh.slot,
                            checksum: fresh.checksum,
                        },
                        Ok(_) => Reply::Refused(Refusal::Flash),
                        Err(refusal) => Reply::Refused(refusal),
                    };
                    line.reply(reply);
                    return Next::Rest;
                }
                Request::FlashBegin(announced) => return Next::Receive(announced),
                Request::Start(start) => return Next::Fly(start),
                _ => answer(line, flash, board, survey),
            },
        }
    }
}
