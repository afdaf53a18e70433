//! The person at the web page.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

use axum::body::Bytes;
use firmware_sim::interrupt;

use super::Listen;
use super::desk::Desk;
use super::scene::{Before, End, Open, Phase, Word};
use super::server::Server;
use crate::ask::clip::ClipSource;
use crate::ask::film::Studio;
use crate::ask::person::{Person, Reply, Review, Turn, Verdict};
use crate::ask::{AskError, Did};
use crate::dataset::Segment;
use crate::preferences::{Answer, LogEntry};

/// A page that is served as long as this is there.
pub struct Page<'a> {
    desk: Arc<Desk>,
    server: Server,
    clips: &'a dyn ClipSource,
    studio: Arc<Studio>,
}

impl<'a> Page<'a> {
    /// Serves a page about a dataset, with films from this studio.
    ///
    /// # Errors
    /// When nothing can be served at this address, or there is no randomness for a secret.
    pub fn open(
        listen: Listen,
        dataset: &str,
        by: &str,
        clips: &'a dyn ClipSource,
        studio: Studio,
    ) -> Result<Self, AskError> {
        let desk = Arc::new(Desk::new(dataset, by));
        let studio = Arc::new(studio);
        let server = Server::start(listen, Arc::clone(&desk), Arc::clone(&studio))?;
        Ok(Self {
            desk,
            server,
            clips,
            studio,
        })
    }

    /// The address that lets a person in.
    #[must_use]
    pub fn address(&self) -> &str {
        self.server.address()
    }

    /// Shows how it ended, and closes the page once that was seen.
    pub fn close(self, end: End) {
        self.desk.show(Phase::Ended { end });
        self.server.stop();
    }
}

impl Page<'_> {
    /// Two clips as they are sent, whose films are made from now on. They come before the scene that shows them; until then there
    /// is none.
    fn clips(&self, segments: [Segment; 2]) -> [Bytes; 2] {
        self.studio.show(segments);
        segments.map(|segment| {
            let picture = self.clips.picture(segment);
            Bytes::from(serde_json::to_vec(&picture).unwrap_or_default())
        })
    }

    /// Shows a scene and waits for what is said about it; none when somebody stops the command.
    fn said(&self, phase: Phase, before: &[LogEntry], clips: Option<[Bytes; 2]>) -> Option<Word> {
        let before = before.iter().map(Before::of).collect();
        heard(&self.desk.ask(phase, before, clips))
    }

    /// Shows what the answers did, one pair of episodes after the other, until somebody says something else.
    fn looked(&self, did: &Did, before: &[LogEntry], open: Open) -> Option<Word> {
        let mut shown = 0;
        loop {
            let pair = did.pairs.get(shown);
            let clips = pair.map(|both| self.clips(both.map(|it| it.segment)));
            match self.said(Phase::did(did, shown, open), before, clips) {
                Some(Word::Turn { pair }) => shown = pair,
                word => return word,
            }
        }
    }
}

impl Person for Page<'_> {
    fn answer(&mut self, turn: Turn<'_>) -> Reply {
        let open = if turn.is_extra() {
            Open::Extra
        } else {
            Open::Question
        };
        loop {
            let clips = self.clips(turn.question.query.segments);
            let phase = Phase::asking(&turn);
            let word = match self.said(phase, turn.before, Some(clips)) {
                Some(Word::Look) => self.looked(&turn.did(), turn.before, open),
                word => word,
            };
            return match word {
                Some(Word::Back) => continue,
                Some(Word::Left) => Reply::Answer(Answer::First),
                Some(Word::Right) => Reply::Answer(Answer::Second),
                Some(Word::Equal) => Reply::Answer(Answer::Equal),
                Some(Word::CannotTell) => Reply::CannotTell,
                Some(Word::Later) => Reply::Later,
                Some(Word::Reopen { place }) => Reply::Reopen(place),
                Some(Word::More) => Reply::More,
                Some(Word::Done) => Reply::Enough,
                Some(Word::Look | Word::Turn { .. }) | None => Reply::Stop,
            };
        }
    }

    fn review(&mut self, review: Review<'_>) -> Verdict {
        let open = match review.stuck {
            Some(_) => Open::Stuck,
            None => Open::Review,
        };
        loop {
            let word = match self.said(Phase::review(&review), review.said, None) {
                Some(Word::Look) => self.looked(&review.did(), review.said, open),
                word => word,
            };
            return match word {
                Some(Word::Back) => continue,
                Some(Word::Done) => Verdict::Done,
                Some(Word::More) => Verdict::More,
                Some(Word::Reopen { place }) => Verdict::Reopen(place),
                _ => Verdict::Stop,
            };
        }
    }
}

/// Waits for a word; none when somebody stops the command.
fn heard(word: &Receiver<Word>) -> Option<Word> {
    loop {
        match word.recv_timeout(Duration::from_millis(100)) {
            Ok(word) => return Some(word),
            Err(RecvTimeoutError::Timeout) if !interrupt::requested() => {}
            Err(_) => return None,
        }
    }
}
