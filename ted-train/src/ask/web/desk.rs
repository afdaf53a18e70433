//! Where the learner and the server meet: the scene that is shown, and the one word that is waited for.

use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use axum::body::Bytes;
use tokio::sync::watch;

use super::scene::{Before, Phase, Scene, Word};

/// The scene as it is sent, with the two clips that go with it.
#[derive(Clone, Debug)]
pub(super) struct Shown {
    pub at: u64,
    pub scene: Bytes,
    /// Left and right; none where nothing is to be watched.
    pub clips: Option<[Bytes; 2]>,
    ended: bool,
}

/// The place where both meet.
pub(super) struct Desk {
    shown: watch::Sender<Shown>,
    now: Mutex<Now>,
    /// How often the last scene was fetched.
    seen: watch::Sender<bool>,
}

/// What the server may change.
struct Now {
    scene: Scene,
    /// Who waits for a word about this scene; none when it was said.
    waits: Option<SyncSender<Word>>,
}

/// A word that came too late, or makes no sense now. Nothing was changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TooLate;

impl Desk {
    pub fn new(dataset: &str, by: &str) -> Self {
        let scene = Scene {
            at: 0,
            dataset: dataset.to_owned(),
            by: by.to_owned(),
            phase: Phase::Looking,
            said: Vec::new(),
        };
        Self {
            shown: watch::Sender::new(shown(&scene, None)),
            now: Mutex::new(Now { scene, waits: None }),
            seen: watch::Sender::new(false),
        }
    }

    /// Shows a scene that nobody has to answer.
    pub fn show(&self, phase: Phase) {
        self.change(|now| {
            now.scene.phase = phase;
            now.waits = None;
        });
    }

    /// Shows a scene, and gives what will be said about it.
    pub fn ask(
        &self,
        phase: Phase,
        said: Vec<Before>,
        clips: Option<[Bytes; 2]>,
    ) -> Receiver<Word> {
        let (waits, word) = sync_channel(1);
        let mut now = self.lock();
        now.scene.at += 1;
        now.scene.phase = phase;
        now.scene.said = said;
        now.waits = Some(waits);
        self.shown.send_replace(shown(&now.scene, clips));
        word
    }

    /// Takes what somebody says about the scene of this number, once.
    pub fn say(&self, at: u64, word: Word) -> Result<(), TooLate> {
        let mut now = self.lock();
        let scene = &now.scene;
        if scene.at != at || !word.fits(&scene.phase, scene.said.len()) {
            return Err(TooLate);
        }
        let waits = now.waits.take().ok_or(TooLate)?;
        waits.try_send(word).map_err(|_| TooLate)?;
        now.scene.at += 1;
        now.scene.phase = word.meanwhile();
        self.shown.send_replace(shown(&now.scene, None));
        Ok(())
    }

    /// The scene after the one of this number, or the same one after this time.
    pub async fn after(&self, at: Option<u64>, patience: Duration) -> Shown {
        let mut watch = self.shown.subscribe();
        let newer = watch.wait_for(|shown| Some(shown.at) != at);
        // Nothing new is an answer too.
        let _ = tokio::time::timeout(patience, newer).await.is_ok();
        let shown = self.shown.borrow().clone();
        if shown.ended {
            self.seen.send_replace(true);
        }
        shown
    }

    /// The scene of now.
    pub fn shown(&self) -> Shown {
        self.shown.borrow().clone()
    }

    /// Waits until somebody has seen how it ended, but not for ever.
    pub async fn seen_to_its_end(&self, patience: Duration) {
        let mut seen = self.seen.subscribe();
        let _ = tokio::time::timeout(patience, seen.wait_for(|seen| *seen))
            .await
            .is_ok();
    }

    fn change(&self, change: impl FnOnce(&mut Now)) {
        let mut now = self.lock();
        now.scene.at += 1;
        change(&mut now);
        self.shown.send_replace(shown(&now.scene, None));
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Now> {
        // Nothing panics while it holds this.
        self.now.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn shown(scene: &Scene, clips: Option<[Bytes; 2]>) -> Shown {
    Shown {
        at: scene.at,
        scene: serde_json::to_vec(scene).unwrap_or_default().into(),
        clips,
        ended: matches!(scene.phase, Phase::Ended { .. }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_said_about_a_scene_counts_once_and_about_another_one_not_at_all() {
        let desk = Desk::new("ted/x-v0", "anna");
        assert_eq!(
            desk.say(0, Word::Left),
            Err(TooLate),
            "nothing is asked yet"
        );
        let review = || Phase::Review { stuck: None };
        let word = desk.ask(review(), Vec::new(), None);
        let at = desk.shown().at;
        assert_eq!(
            desk.say(at, Word::Left),
            Err(TooLate),
            "that is no answer to it"
        );
        assert_eq!(
            desk.say(at, Word::Reopen { place: 0 }),
            Err(TooLate),
            "there is none"
        );
        assert_eq!(desk.say(at - 1, Word::Done), Err(TooLate), "of another tab");
        assert_eq!(desk.say(at, Word::Done), Ok(()));
        assert_eq!(desk.say(at, Word::Done), Err(TooLate), "said twice");
        assert_eq!(word.recv(), Ok(Word::Done));
        let stuck = Phase::Review {
            stuck: Some(String::new()),
        };
        let _word = desk.ask(stuck, Vec::new(), None);
        assert_eq!(desk.say(desk.shown().at, Word::Done), Err(TooLate));
    }
}
