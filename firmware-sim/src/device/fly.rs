//! Flying an episode: ticks in, actions out, and the safe action when no tick comes.

use embedded_io::{Read, ReadReady, Write};
use ted_core::{DiscountClass, MAX_ACTION, MAX_OBSERVATION, NEW_EPISODE};
use ted_policy::Artifact;

use super::line::{Event, Line, Patience};
use super::message::{Acted, Refusal, Reply, Request, Score, Start};
use super::serve::{Next, answer};
use super::slots::{Active, Survey, Transfer, refusal};
use super::{Board, MappedFlash};
use crate::controller::{BareController, Numeric};
use crate::proven::Proven;
use crate::safety::ObservationFrame;
use crate::scorer::BareScorer;
use crate::workspace::Workspace;

/// An action is out that nobody but the next tick takes back: how long that may take, and the number of its request.
struct Watch {
    patience: Patience,
    number: u16,
}

/// Answers a [`Request::Start`] and what follows it, until the host wants something else.
pub(super) fn fly<L, F, B>(
    line: &mut Line<L>,
    flash: &F,
    board: &mut B,
    survey: &Survey,
    start: Start,
) -> Next
where
    L: Read + ReadReady + Write,
    F: MappedFlash,
    B: Board,
{
    let active = match may_fly(board, survey, start) {
        Ok(active) => active,
        Err(refusal) => {
            line.reply(Reply::Refused(refusal));
            return Next::Rest;
        }
    };
    let bytes = active.bytes(flash);
    let flown = prove(bytes, start.numeric)
        .and_then(|proven| load_and_fly(line, flash, board, survey, start, bytes, proven));
    match flown {
        Ok(next) => next,
        Err(refusal) => {
            // The flash is not what it was when it was surveyed; the other slot may still be good.
            line.reply(Reply::Refused(refusal));
            Next::Survey
        }
    }
}

/// What flies when an episode is started like that.
fn may_fly<'s>(
    board: &impl Board,
    survey: &'s Survey,
    start: Start,
) -> Result<&'s Active, Refusal> {
    if start.silence_us > 0 && !board.notices_silence() {
        return Err(Refusal::CannotWatch);
    }
    survey.flies(start.numeric)
}

// The functions below are apart, and kept apart, so that what only one of them needs is on the stack while it runs and no
// longer: the networks' working memory while they are tried and while they fly, the artefact while it is read.

/// Tries the golden vectors again, since nobody knows what became of the flash meanwhile.
#[inline(never)]
fn prove(bytes: &[u8], numeric: Numeric) -> Result<Proven, Refusal> {
    let artifact = Artifact::parse(bytes).map_err(refusal)?;
    Proven::of(&artifact, numeric).map_err(refusal)
}

#[inline(never)]
fn load_and_fly<L, F, B>(
    line: &mut Line<L>,
    flash: &F,
    board: &mut B,
    survey: &Survey,
    start: Start,
    bytes: &[u8],
    proven: Proven,
) -> Result<Next, Refusal>
where
    L: Read + ReadReady + Write,
    F: MappedFlash,
    B: Board,
{
    let artifact = Artifact::parse(bytes).map_err(refusal)?;
    // Used where it is: moved, it would be on the stack twice.
    let mut loaded = BareController::load(&artifact, proven);
    let controller = loaded.as_mut().map_err(|error| refusal(*error))?;
    let mut place = BareScorer::unfilled(&artifact, proven.numeric());
    let scorer = place
        .as_mut()
        .and_then(|scorer| scorer.fill(&artifact).then_some(scorer));
    let mut flyer = Flyer { controller, scorer };
    Ok(flyer.fly(line, flash, board, survey, start))
}

/// What flies.
struct Flyer<'f, 'a> {
    controller: &'f mut BareController<'a>,
    scorer: Option<&'f mut BareScorer<'a>>,
}

impl Flyer<'_, '_> {
    #[inline(never)]
    fn fly<L, F, B>(
        &mut self,
        line: &mut Line<L>,
        flash: &F,
        board: &mut B,
        survey: &Survey,
        mut start: Start,
    ) -> Next
    where
        L: Read + ReadReady + Write,
        F: MappedFlash,
        B: Board,
    {
        let mut workspace = Workspace::new(start.numeric);
        line.reply(Reply::Done);
        let mut watch: Option<Watch> = None;
        loop {
            let patience = watch.as_mut().map(|watch| &mut watch.patience);
            match line.wait(board, patience) {
                Event::Closed => return Next::Stop,
                Event::Silence => self.stop(line, watch.take(), start.silence_us),
                Event::Request => match line.request() {
                    Request::Tick { .. } => {
                        // Only a tick that sent an action is one; and what it took to compute is no silence of the link.
                        if self.tick(line, board, &mut workspace) && start.silence_us > 0 {
                            watch = Some(Watch {
                                patience: Patience::new(board, start.silence_us),
                                number: line.number(),
                            });
                        }
                    }
                    Request::Log { .. } => self.log(line, board, &mut workspace),
                    Request::Rearm => {
                        if let Some(watch) = &mut watch {
                            watch.patience = Patience::new(board, start.silence_us);
                        }
                        self.controller.rearm();
                        line.reply(Reply::Done);
                    }
                    // What ends the flight is refused while it lasts, or stops the plant first.
                    Request::Start(next) => match may_fly(board, survey, next) {
                        Err(refusal) => line.reply(Reply::Refused(refusal)),
                        Ok(_) => {
                            self.stop(line, watch.take(), start.silence_us);
                            if next.numeric != start.numeric {
                                return Next::Fly(next);
                            }
                            start = next;
                            self.reset();
                            line.reply(Reply::Done);
                        }
                    },
                    Request::FlashBegin(announced) => match Transfer::fits(flash, &announced) {
                        Err(refusal) => line.reply(Reply::Refused(refusal)),
                        Ok(()) => {
                            self.stop(line, watch.take(), start.silence_us);
                            return Next::Receive(announced);
                        }
                    },
                    _ => answer(line, flash, board, survey),
                },
            }
        }
    }

    fn reset(&mut self) {
        self.controller.reset();
        if let Some(scorer) = &mut self.scorer {
            scorer.reset();
        }
    }

    /// Sends the safe action if another one is out and watched.
    // Apart, like the functions below: what one has on the stack is not there while another runs.
    #[inline(never)]
    fn stop<L>(&mut self, line: &mut Line<L>, watch: Option<Watch>, silence_us: u32)
    where
        L: Read + ReadReady + Write,
    {
        let Some(Watch { number, .. }) = watch else {
            return;
        };
        let (action, status) = self.controller.tick_without_observation(silence_us);
        let silent = Acted {
            action,
            status,
            work: 0,
            score: None,
        };
        line.tell(number, Reply::Silent(silent));
    }

    /// Whether an action went out.
    #[inline(never)]
    fn tick<L, B>(&mut self, line: &mut Line<L>, board: &mut B, workspace: &mut Workspace) -> bool
    where
        L: Read + ReadReady + Write,
        B: Board,
    {
        let Request::Tick {
            now_us,
            sequence,
            stamp_us,
            values,
        } = line.request()
        else {
            return false;
        };
        let mut room = [0.0; MAX_OBSERVATION];
        let Some(values) = values.copy_to(&mut room) else {
            line.reply(Reply::Refused(Refusal::Malformed));
            return false;
        };
        let frame = ObservationFrame {
            sequence,
            stamp_us,
            values,
        };
        let before = board.work();
        let (action, status) = self.controller.tick(now_us, &frame, workspace);
        let after = board.work();
        // An observation that cannot be flown on says nothing about the episode; without a fault the lengths fit.
        let step = match status.fault {
            None => Some((values, action.as_slice())),
            Some(_) => None,
        };
        // Where the lengths fit, the only reason not to score is that there is nothing to score with.
        let score = self.score(step, NEW_EPISODE, board, workspace).ok();
        line.reply(Reply::Acted(Acted {
            action,
            status,
            work: after.wrapping_sub(before),
            score,
        }));
        true
    }

    /// Scores a step that nobody flies now.
    #[inline(never)]
    fn log<L, B>(&mut self, line: &mut Line<L>, board: &mut B, workspace: &mut Workspace)
    where
        L: Read + ReadReady + Write,
        B: Board,
    {
        let Request::Log {
            episode,
            observation,
            action,
        } = line.request()
        else {
            return;
        };
        let mut seen = [0.0; MAX_OBSERVATION];
        let mut sent = [0.0; MAX_ACTION];
        let step = observation
            .copy_to(&mut seen)
            .zip(action.copy_to(&mut sent));
        let scored = match step {
            Some(_) => self.score(step, episode, board, workspace),
            None => Err(Refusal::Malformed),
        };
        line.reply(match scored {
            Ok(score) => Reply::Scored(score),
            Err(refusal) => Reply::Refused(refusal),
        });
    }

    /// Adds a step, what was seen and what went out, to the episode's return.
    // Once in the image: two callers would otherwise each have it, and the networks with it.
    #[inline(never)]
    fn score<B: Board>(
        &mut self,
        step: Option<(&[f32], &[f32])>,
        episode: u32,
        board: &mut B,
        workspace: &mut Workspace,
    ) -> Result<Score, Refusal> {
        let before = board.work();
        let scorer = self.scorer.as_mut().ok_or(Refusal::CannotScore)?;
        if let Some((observation, action)) = step {
            scorer
                .push(observation, &self.controller.unit(action), workspace)
                .map_err(|_| Refusal::OtherShape)?;
        }
        Ok(Score {
            return_hat: scorer.return_hat(),
            top_k: scorer.class(episode) == DiscountClass::TopK,
            work: board.work().wrapping_sub(before),
        })
    }
}
