//! Why no reward was learned.

use firmware_sim::disk::WriteError;

use crate::checkpoint::ForeignCheckpoint;
use crate::dataset::SegmentError;
use crate::preferences::PreferenceError;

/// Why no reward was learned from answers.
#[derive(Debug, thiserror::Error)]
pub enum LearnError {
    /// The dataset has no segment of the length asked for.
    #[error(transparent)]
    Segment(#[from] SegmentError),
    /// There is nothing to compare.
    #[error(
        "the dataset has fewer than two episodes, so there is nothing to compare: collect more"
    )]
    TooFewEpisodes,
    /// An answer could not be had or kept.
    #[error(transparent)]
    Preference(#[from] PreferenceError),
    /// The saved state is of another model.
    #[error(transparent)]
    Foreign(#[from] ForeignCheckpoint),
    /// The state could not be saved.
    #[error(transparent)]
    Save(#[from] WriteError),
    /// A loss is no longer a number.
    #[error(
        "the reward loss is not finite after {after}: the learning rate or the inputs are too large"
    )]
    Diverged {
        /// How far it had come.
        after: String,
    },
    /// Somebody asked to stop.
    #[error("stopped while learning a reward: every answer is kept and the same command goes on")]
    Interrupted,
}
