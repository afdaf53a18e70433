//! Why a collection ended early.

use super::Recipe;
use crate::dataset::DatasetError;
use crate::dataset::minari::EpisodeError;
use crate::need::TooMuch;
use firmware_sim::bridge::BridgeError;
use firmware_sim::bridge::environment::SetupError;
use firmware_sim::disk::WriteError;
use firmware_sim::exit::ExitCode;
use firmware_sim::worlds::TaskError;

/// Why a collection ended early. Whatever was complete by then is kept.
#[derive(Debug, thiserror::Error)]
pub enum CollectError {
    /// No such task.
    #[error(transparent)]
    Task(#[from] TaskError),
    /// No such recipe.
    #[error("no recipe `{name}`: the recipes are {known}")]
    Recipe {
        /// What was asked for.
        name: String,
        /// What there is.
        known: String,
    },
    /// A dataset of nothing.
    #[error("a dataset needs at least one episode")]
    NoEpisodes,
    /// More good episodes than there are.
    #[error("{good} good episodes of {total}: --good counts some of --episodes")]
    TooManyGood {
        /// Good ones asked for.
        good: u32,
        /// Episodes of the dataset.
        total: u32,
    },
    /// The recipe has no good part.
    #[error(
        "the recipe `{recipe}` has no good and bad episodes to choose the number of: leave --good out"
    )]
    NoGoodPart {
        /// The recipe.
        recipe: Recipe,
    },
    /// There is no scripted policy.
    #[error(
        "{task} has no scripted policy to record: `ted import` reads the logs that others recorded"
    )]
    NoScript {
        /// The task.
        task: &'static str,
    },
    /// The scripted policy's actions cannot be pushed, and cannot drift.
    #[error("{task} cannot be recorded by the recipe `{recipe}`: it has paper and expert")]
    NoPush {
        /// The task.
        task: &'static str,
        /// The recipe.
        recipe: Recipe,
    },
    /// More than the machine has memory for.
    #[error(transparent)]
    TooMuch(#[from] TooMuch),
    /// There is no simulator.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The simulator failed.
    #[error(transparent)]
    Bridge(#[from] BridgeError),
    /// What was to be recorded is no dataset.
    #[error(transparent)]
    Dataset(#[from] DatasetError),
    /// The dataset cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The person asked to stop.
    #[error(
        "stopped on request with {done} of {total} episodes complete; the same command goes on from there"
    )]
    Interrupted {
        /// Episodes on the disk.
        done: usize,
        /// Episodes asked for.
        total: u32,
    },
}

impl CollectError {
    /// The exit status for a command that ends with this error.
    #[must_use]
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::Task(_)
            | Self::Recipe { .. }
            | Self::NoEpisodes
            | Self::TooManyGood { .. }
            | Self::NoScript { .. }
            | Self::NoPush { .. }
            | Self::TooMuch(_)
            | Self::NoGoodPart { .. } => ExitCode::Usage,
            Self::Setup(error) => error.exit_code(),
            Self::Bridge(error) => error.exit_code(),
            Self::Dataset(_) => ExitCode::BadInput,
            Self::Write(error) => error.exit_code(),
            Self::Interrupted { .. } => ExitCode::Interrupted,
        }
    }
}

impl From<EpisodeError> for CollectError {
    fn from(error: EpisodeError) -> Self {
        match error {
            EpisodeError::Refused(error) => Self::Dataset(error),
            EpisodeError::Write(error) => Self::Write(error),
        }
    }
}
