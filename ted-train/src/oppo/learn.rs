//! The procedure: ask about random pairs, then train everything together.

use firmware_sim::disk::WriteError;
use firmware_sim::interrupt;
use firmware_sim::progress::Audience;

use crate::dataset::{Dataset, SegmentError, SegmentSampler};
use crate::nn::Backend;
use crate::preferences::{PreferenceError, PreferenceLog, Teacher};
use crate::reward::ask_random_pairs;
use crate::rng::Seed;
use crate::run::{Checkpoint, ForeignCheckpoint};

use super::config::OppoConfig;
use super::update::{Oppo, UpdateLosses};

/// Updates between two saved states.
const SAVE_EVERY: u64 = 100;

/// A trained learner, whose policy a [`super::Player`] plays.
pub struct Learned {
    /// The learner.
    pub oppo: Oppo,
    /// Losses of the last two updates, of which one trained the policy.
    pub losses: [UpdateLosses; 2],
}

/// Why no policy was learned.
#[derive(Debug, thiserror::Error)]
pub enum OppoError {
    /// The dataset has no segment of the length asked for.
    #[error(transparent)]
    Segment(#[from] SegmentError),
    /// An answer could not be had or kept.
    #[error(transparent)]
    Preference(#[from] PreferenceError),
    /// The saved state is of another learner.
    #[error(transparent)]
    Foreign(#[from] ForeignCheckpoint),
    /// The state could not be saved.
    #[error(transparent)]
    Save(#[from] WriteError),
    /// A loss is no longer a number.
    #[error(
        "a loss of OPPO is not finite after {step} updates: the learning rates or the inputs are too large"
    )]
    Diverged {
        /// Updates made.
        step: u64,
    },
    /// Somebody asked to stop.
    #[error(
        "stopped after {step} updates: every answer is kept and the same command goes on from there"
    )]
    Interrupted {
        /// Updates made and saved.
        step: u64,
    },
}

/// Learns from exactly `queries` answers, each appended to `log` before it is used. Goes on from `saved`, the state that was
/// last given to `save`, with the bits of a training that was never stopped.
///
/// # Errors
/// When the dataset has no segment that long, the teacher, the log or `save` fails, the saved state does not fit, a loss is
/// not finite, or somebody asks to stop.
#[expect(
    clippy::too_many_arguments,
    reason = "what is learned from, by whom, and where it is kept"
)]
pub fn learn(
    config: &OppoConfig,
    dataset: &Dataset,
    teacher: &mut dyn Teacher,
    log: &mut PreferenceLog,
    seed: Seed,
    backend: Backend,
    saved: Option<&Checkpoint>,
    save: &mut dyn FnMut(&Checkpoint) -> Result<(), WriteError>,
    audience: Audience,
) -> Result<Learned, OppoError> {
    let sampler = SegmentSampler::new(dataset, config.segment)?;
    let pairs = ask_random_pairs(config.queries, dataset, &sampler, teacher, log, seed)?;
    let mut oppo = Oppo::new(config, dataset, seed, backend);
    if let Some(saved) = saved {
        oppo.restore(saved)?;
    }
    let progress = audience.start("learn a policy", config.steps, "updates");
    progress.skip(oppo.step());
    let mut losses = [UpdateLosses::default(); 2];
    while oppo.step() < config.steps {
        let now = oppo.update(dataset, &sampler, &pairs);
        let step = oppo.step();
        if !(now.reconstruction + now.preference + now.norm).is_finite() {
            return Err(OppoError::Diverged { step });
        }
        losses = [losses[1], now];
        progress.advance(1);
        let stop = interrupt::requested();
        if stop || step.is_multiple_of(SAVE_EVERY) {
            save(&oppo.checkpoint())?;
        }
        if stop {
            return Err(OppoError::Interrupted { step });
        }
    }
    progress.finish();
    Ok(Learned { oppo, losses })
}
