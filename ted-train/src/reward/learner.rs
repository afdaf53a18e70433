//! What all ways to learn a reward from answers have in common, as a run sees them.

use firmware_sim::disk::WriteError;
use firmware_sim::progress::Audience;
use serde::{Deserialize, Serialize};

use crate::checkpoint::Checkpoint;
use crate::dataset::Dataset;
use crate::nn::Backend;
use crate::preferences::{Interview, LabelledPair, LogEntry};
use crate::rng::Seed;

use super::{Fit, HeldOut, LearnError, RewardModel, Standing};

/// A way to learn a reward from answers: the configuration of one, which knows what to do with it.
pub trait RewardLearner {
    /// Whether the dataset has what it asks about.
    ///
    /// # Errors
    /// When it has not.
    fn check(&self, dataset: &Dataset) -> Result<(), LearnError>;

    /// How many answers it asks for.
    fn queries(&self) -> usize;

    /// Asks what does not depend on anything that is learned.
    ///
    /// # Errors
    /// When [`Self::check`] does, or an answer cannot be had or kept.
    fn ask(
        &self,
        on: Material<'_>,
        interview: &mut Interview<'_>,
    ) -> Result<Vec<LabelledPair>, LearnError>;

    /// Learns from these answers, and from those to what it asks on the way. Where that takes long enough to be gone on with,
    /// it gives what it has come to `save` now and then.
    ///
    /// # Errors
    /// When an answer cannot be had or kept, `save` fails, a loss is not finite, or somebody asks to stop.
    fn learn(
        &self,
        answers: &[LabelledPair],
        on: Material<'_>,
        interview: &mut Interview<'_>,
        save: Save<'_>,
    ) -> Result<Learned, LearnError>;

    /// What it asks, by itself. What does not depend on answers is computed here, once.
    ///
    /// # Errors
    /// When [`Self::check`] does, or what is computed beforehand cannot be.
    fn questions<'a>(&'a self, on: Material<'a>) -> Result<Box<dyn Questions + 'a>, LearnError>;

    /// Goes on from what was last saved while it learned from the same answers, to the bits of a training that was never
    /// stopped. Who saves nothing begins again.
    ///
    /// # Errors
    /// When [`Self::learn`] does, or what was saved is of another model.
    fn resume(
        &self,
        saved: Saved,
        answers: &[LabelledPair],
        on: Material<'_>,
        interview: &mut Interview<'_>,
        save: Save<'_>,
    ) -> Result<Learned, LearnError> {
        drop(saved);
        self.learn(answers, on, interview, save)
    }

    /// Whether it takes so long that a run had better wait for another one that learns the same.
    fn takes_long(&self) -> bool {
        false
    }

    /// How far it had come, in its own count, when it looked at its fit for the `index`-th time.
    fn looked_at(&self, index: u64) -> u64 {
        index
    }
}

/// What a learner works with.
#[derive(Clone, Copy)]
pub struct Material<'a> {
    /// What there is to see.
    pub dataset: &'a Dataset,
    /// Where everything random comes from.
    pub seed: Seed,
    /// What computes.
    pub backend: Backend,
    /// Who is told how far it has come.
    pub audience: Audience,
}

/// What a learner asks, as something that can be done again and again with another log: a person may take answers back, and give
/// more of them than the configuration wants.
pub trait Questions {
    /// Asks until there are so many answers. The first of them are those to the same questions, however many there are to be.
    ///
    /// # Errors
    /// When an answer cannot be had or kept, what is learned on the way diverges, or somebody asks to stop.
    fn ask(&self, interview: &mut Interview<'_>, answers: usize) -> Result<(), LearnError>;

    /// What the answers in this log did; none where that is known only once a reward is learned from all of them.
    fn standing(&self, _said: &[LogEntry]) -> Option<Standing> {
        None
    }
}

impl<F> Questions for F
where
    F: Fn(&mut Interview<'_>, usize) -> Result<(), LearnError>,
{
    fn ask(&self, interview: &mut Interview<'_>, answers: usize) -> Result<(), LearnError> {
        self(interview, answers)
    }
}

/// Keeps what a learner has come to.
pub type Save<'a> = &'a mut dyn FnMut(&Saved) -> Result<(), WriteError>;

/// What a training goes on from.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Saved {
    /// Everything that the next step depends on.
    pub checkpoint: Checkpoint,
    /// The fits so far.
    pub fits: Vec<Fit>,
}

/// What a learner leaves.
#[derive(Clone, Debug)]
pub struct Learned {
    /// What it says of every transition.
    pub model: RewardModel,
    /// Fit of the training pairs, every time that it looked.
    pub fits: Vec<Fit>,
    /// Agreement on pairs that were not asked.
    pub held_out: HeldOut,
}
