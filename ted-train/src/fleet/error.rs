//! Why a run of a fleet ended without an artefact or its evaluation.

use std::path::PathBuf;

use crate::collect::CollectError;
use crate::dataset::DatasetError;
use crate::evaluate::EvaluateError;
use crate::preferences::PreferenceError;
use crate::run::RunError;
use crate::train::TrainError;

/// Why a run ended.
#[derive(Debug, thiserror::Error)]
pub enum LaneError {
    /// Its dataset.
    #[error(transparent)]
    Dataset(#[from] DatasetError),
    /// Its dataset was missing and could not be collected.
    #[error(transparent)]
    Collect(#[from] CollectError),
    /// The answers it was given.
    #[error(transparent)]
    Preference(#[from] PreferenceError),
    /// Its folder.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The training.
    #[error(transparent)]
    Train(#[from] TrainError),
    /// The flight.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
    /// The operating system gave no threads.
    #[error("cannot start the threads of a run: {0}")]
    Threads(String),
    /// A mistake in this program.
    #[error(
        "the run ended in a panic, which is a mistake of this program: please report what it said above"
    )]
    Panicked,
    /// Somebody asked to stop before its turn came.
    #[error("not begun: somebody asked to stop")]
    NotBegun,
}

/// Not all runs of a fleet were finished; those that were are kept, and the same command does the others.
#[derive(Debug, thiserror::Error)]
#[error("{failed} of {lanes} runs were not finished; the first is {folder}: {first}")]
pub struct FleetError {
    /// How many.
    pub failed: usize,
    /// Of how many.
    pub lanes: usize,
    /// The folder of the first.
    pub folder: PathBuf,
    /// Why it was not.
    pub first: Box<LaneError>,
}
