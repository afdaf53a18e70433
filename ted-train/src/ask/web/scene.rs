//! What the page shows at a moment.

use serde::{Deserialize, Serialize};

use crate::ask::person::{Review, Turn};
use crate::ask::{Did, Odd, words};
use crate::preferences::{Answer, LogEntry};
use crate::reward::Ranked;

/// What the page shows, with a number that no other moment of the process has.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Scene {
    /// Rises with every change. Whoever acts says at which moment they meant to.
    pub at: u64,
    /// The dataset's id.
    pub dataset: String,
    /// Who answers.
    pub by: String,
    #[serde(flatten)]
    pub phase: Phase,
    /// What was said so far, all of it on the disk.
    pub said: Vec<Before>,
}

/// What there is to do.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "phase", rename_all = "kebab-case")]
pub(super) enum Phase {
    /// Wait: the logs are looked at.
    Looking,
    /// Wait: the next question is chosen.
    Thinking,
    /// Wait: what somebody wants to see is got ready.
    Preparing,
    /// Answer.
    Asking {
        number: usize,
        of: usize,
        why: Option<String>,
        /// Episodes on the left and on the right.
        episodes: [u32; 2],
    },
    /// Look at what the answers did.
    Did {
        /// Where the page was when somebody wanted to know.
        open: Open,
        says: Vec<String>,
        odd: Vec<Odd>,
        /// Which of so many pairs is shown.
        pair: usize,
        pairs: usize,
        /// Left the best and right the worst; none where nobody can say.
        shown: Option<[Shown; 2]>,
    },
    /// Say that these are the answers.
    Review { stuck: Option<String> },
    /// Close the page.
    Ended { end: End },
}

/// What was open when somebody wanted to know what the answers did.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Open {
    /// A question.
    Question,
    /// A question beyond those that were wanted at first.
    Extra,
    /// Every question is answered.
    Review,
    /// No more can be asked.
    Stuck,
}

/// An episode that is shown because of what is believed of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Shown {
    episode: u32,
    /// How far it is above the mean of the logs, in standard deviations.
    above: f64,
}

/// How it ended.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "how", content = "text", rename_all = "kebab-case")]
pub enum End {
    /// The answers are in, and this is the next command.
    Next(String),
    /// The answers are in, and the run goes on by itself.
    GoesOn,
    /// Something went wrong, or somebody stopped it.
    Stopped(String),
}

/// A question that was asked before.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(super) struct Before {
    said: Said,
    episodes: [u32; 2],
    by: String,
}

/// What was said.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Said {
    Left,
    Right,
    Equal,
    CannotTell,
    Later,
}

/// What somebody does, as the page sends it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(tag = "say", rename_all = "kebab-case", deny_unknown_fields)]
pub(super) enum Word {
    /// The left one is better.
    Left,
    /// The right one is better.
    Right,
    /// They are equally good.
    Equal,
    /// They cannot tell.
    CannotTell,
    /// Not now.
    Later,
    /// Ask the question of this place in the log again.
    Reopen { place: usize },
    /// What did the answers do?
    Look,
    /// Show this pair of what they did.
    Turn { pair: usize },
    /// Back to where it was.
    Back,
    /// More answers are wanted.
    More,
    /// These are the answers.
    Done,
}

impl Word {
    /// Whether it makes sense at such a moment.
    pub fn fits(self, phase: &Phase, said: usize) -> bool {
        match (self, phase) {
            (
                Self::Reopen { place },
                Phase::Asking { .. } | Phase::Did { .. } | Phase::Review { .. },
            ) => place < said,
            (Self::Look, Phase::Asking { .. } | Phase::Review { .. }) => true,
            (Self::Turn { pair }, Phase::Did { pairs, .. }) => pair < *pairs,
            (Self::Back, Phase::Did { .. }) => true,
            (Self::More, Phase::Did { open, .. }) => *open != Open::Stuck,
            (Self::Done, Phase::Did { open, .. }) => matches!(open, Open::Extra | Open::Review),
            (Self::Done, Phase::Review { stuck }) => stuck.is_none(),
            (
                Self::Left | Self::Right | Self::Equal | Self::CannotTell | Self::Later,
                Phase::Asking { .. },
            ) => true,
            _ => false,
        }
    }

    /// What is shown until something comes of it.
    pub fn meanwhile(self) -> Phase {
        match self {
            Self::Look | Self::Turn { .. } | Self::Back => Phase::Preparing,
            _ => Phase::Thinking,
        }
    }
}

impl Phase {
    /// A question.
    pub fn asking(turn: &Turn<'_>) -> Self {
        Self::Asking {
            number: turn.number,
            of: turn.of,
            why: turn.question.why.as_deref().map(words::why),
            episodes: turn.question.query.segments.map(|it| it.episode()),
        }
    }

    /// What the answers did, with this pair of episodes.
    pub fn did(did: &Did, pair: usize, open: Open) -> Self {
        let shown = |it: Ranked| Shown {
            episode: it.segment.episode(),
            above: it.above,
        };
        Self::Did {
            open,
            says: did.says.clone(),
            odd: did.odd.clone(),
            pair,
            pairs: did.pairs.len(),
            shown: did.pairs.get(pair).map(|both| both.map(shown)),
        }
    }

    /// No question.
    pub fn review(review: &Review<'_>) -> Self {
        Self::Review {
            stuck: review.stuck.map(str::to_owned),
        }
    }
}

impl Before {
    pub fn of(entry: &LogEntry) -> Self {
        Self {
            said: match entry.said.answer {
                Some(Answer::First) => Said::Left,
                Some(Answer::Second) => Said::Right,
                Some(Answer::Equal) => Said::Equal,
                None if entry.said.later => Said::Later,
                None => Said::CannotTell,
            },
            episodes: entry.question.query.segments.map(|it| it.episode()),
            by: entry.said.by.clone(),
        }
    }
}
