//! The person at the web page.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

use axum::body::Bytes;
use firmware_sim::interrupt;

use super::Listen;
use super::desk::Desk;
use super::scene::{Before, End, Phase, Word};
use super::server::Server;
use crate::ask::AskError;
use crate::ask::clip::ClipSource;
use crate::ask::film::Studio;
use crate::ask::person::{Person, Reply, Review, Turn, Verdict};
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

impl Person for Page<'_> {
    fn answer(&mut self, turn: Turn<'_>) -> Reply {
        // Before the scene that asks for them; until then there is none.
        self.studio.show(turn.question.query.segments);
        let clips = turn.question.query.segments.map(|segment| {
            let picture = self.clips.picture(segment);
            Bytes::from(serde_json::to_vec(&picture).unwrap_or_default())
        });
        let said = said(turn.before);
        let word = self.desk.ask(Phase::asking(&turn), said, Some(clips));
        match heard(&word) {
            Some(Word::Left) => Reply::Answer(Answer::First),
            Some(Word::Right) => Reply::Answer(Answer::Second),
            Some(Word::Equal) => Reply::Answer(Answer::Equal),
            Some(Word::CannotTell) => Reply::CannotTell,
            Some(Word::Later) => Reply::Later,
            Some(Word::Reopen { place }) => Reply::Reopen(place),
            Some(Word::Done) | None => Reply::Stop,
        }
    }

    fn review(&mut self, review: Review<'_>) -> Verdict {
        let word = self
            .desk
            .ask(Phase::review(&review), said(review.said), None);
        match heard(&word) {
            Some(Word::Done) => Verdict::Done,
            Some(Word::Reopen { place }) => Verdict::Reopen(place),
            _ => Verdict::Stop,
        }
    }
}

fn said(entries: &[LogEntry]) -> Vec<Before> {
    entries.iter().map(Before::of).collect()
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
