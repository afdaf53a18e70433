//! Who watches a run, and what of it.

use std::ops::Deref;

use firmware_sim::progress::{Audience, Progress};

/// Who watches a run.
#[derive(Clone, Copy, Debug)]
pub enum Watch<'p> {
    /// Somebody who waits for this run alone and sees all of it.
    Alone(Audience),
    /// Somebody who waits for many: its updates are part of one piece of work, and nothing else of it is shown.
    Fleet(&'p Progress),
}

impl<'p> Watch<'p> {
    /// Who is told about the pieces of the run.
    #[must_use]
    pub fn audience(self) -> Audience {
        match self {
            Self::Alone(audience) => audience,
            Self::Fleet(_) => Audience::Nobody,
        }
    }

    /// Who is told about work that is none of a run's, and that many may wait for.
    #[must_use]
    pub fn beside(self) -> Audience {
        match self {
            Self::Alone(audience) => audience,
            Self::Fleet(whole) => whole.beside(),
        }
    }

    /// Says one line that is of interest to whoever waits, for this run or for many.
    pub fn note(self, line: &str) {
        match self {
            Self::Alone(audience) => audience.note(line),
            Self::Fleet(whole) => whole.note(line),
        }
    }

    /// Begins the updates of the run.
    pub(super) fn updates(self, steps: u64) -> Updates<'p> {
        match self {
            Self::Alone(audience) => {
                Updates::Own(audience.start("learn a policy", steps, "updates"))
            }
            Self::Fleet(whole) => Updates::Part(whole),
        }
    }
}

/// The updates of a run, as somebody sees them.
#[derive(Debug)]
pub(super) enum Updates<'p> {
    /// All there is to see.
    Own(Progress),
    /// A part of the updates of a fleet.
    Part(&'p Progress),
}

impl Updates<'_> {
    /// Says something about this run.
    pub(super) fn say(&self, message: &str) {
        if let Self::Own(progress) = self {
            progress.message(message);
        }
    }

    /// Ends them.
    pub(super) fn finish(self) {
        if let Self::Own(progress) = self {
            progress.finish();
        }
    }
}

impl Deref for Updates<'_> {
    type Target = Progress;

    fn deref(&self) -> &Progress {
        match self {
            Self::Own(progress) => progress,
            Self::Part(progress) => progress,
        }
    }
}

impl From<Audience> for Watch<'_> {
    fn from(audience: Audience) -> Self {
        Self::Alone(audience)
    }
}
