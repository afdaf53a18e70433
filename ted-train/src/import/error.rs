//! Why a source was not imported, and the way out of each.

use std::io;

use firmware_sim::bridge::environment::SetupError;
use firmware_sim::disk::WriteError;
use firmware_sim::exit::ExitCode;
use firmware_sim::last_words::LastWords;

use crate::dataset::DatasetError;
use crate::dataset::minari::EpisodeError;

/// Why a source was not imported.
#[derive(Debug, thiserror::Error)]
pub enum ImportError {
    /// There is no reader.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// Its process could not be started.
    #[error("start the reader of logs: {0}; `ted doctor` looks at the Python that is there")]
    Start(io::Error),
    /// It ended by itself.
    #[error("the reader of logs ended before it had read everything{0}")]
    Ended(LastWords),
    /// It found fault with the source.
    #[error("{place}{what}; {way_out}")]
    Fault {
        /// Episode and step, if it has a place.
        place: String,
        /// What is wrong.
        what: String,
        /// The way out.
        way_out: String,
    },
    /// No episode was left.
    #[error(
        "the source has no episode with a step in it; `ted import SOURCE --describe` says what is there"
    )]
    Nothing,
    /// The robot has other channels than the source.
    #[error(
        "the robot {robot:?} has {declared} {kind} channels, and the source {found}: {names}; correct the robot's file, or choose others with --observations, --actions or --map"
    )]
    OtherRobot {
        /// Its name.
        robot: String,
        /// Observation or action.
        kind: &'static str,
        /// How many are declared.
        declared: usize,
        /// How many there are.
        found: usize,
        /// What they are called.
        names: String,
    },
    /// Actions outside of their ranges.
    #[error("{count} actions are outside of their ranges, the first is {value} of {channel} ({}, {}) in episode {episode}, step {step}; correct the ranges in the robot's file, or clip them with --clip", range[0], range[1])]
    ActionRange {
        /// How many numbers.
        count: u64,
        /// The first one.
        value: f64,
        /// Its channel.
        channel: String,
        /// The range of that.
        range: [f32; 2],
        /// Its episode.
        episode: String,
        /// Its step.
        step: usize,
    },
    /// Not what is learned from.
    #[error(transparent)]
    Dataset(#[from] DatasetError),
    /// An episode could not be written.
    #[error(transparent)]
    Episode(#[from] EpisodeError),
    /// The disk.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Somebody asked to stop.
    #[error("stopped after {0} episodes; the same command goes on from there")]
    Interrupted(u32),
}

/// What an episode is called in a message: some sources number theirs, some give them names.
pub(super) fn called(episode: &str) -> String {
    match episode.starts_with("episode") {
        true => episode.to_owned(),
        false => format!("episode {episode}"),
    }
}

impl ImportError {
    pub(super) fn fault(
        episode: Option<String>,
        step: Option<u64>,
        what: String,
        way_out: String,
    ) -> Self {
        let episode = episode.map_or_else(String::new, |it| format!("{}: ", called(&it)));
        let step = step.map_or_else(String::new, |it| format!("step {it}: "));
        Self::Fault {
            place: format!("{episode}{step}"),
            what,
            way_out,
        }
    }

    /// How a command ends with it.
    #[must_use]
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::Setup(error) => error.exit_code(),
            Self::Start(_) | Self::Ended(_) => ExitCode::Environment,
            Self::Write(error) | Self::Episode(EpisodeError::Write(error)) => error.exit_code(),
            Self::Interrupted(_) => ExitCode::Interrupted,
            _ => ExitCode::BadInput,
        }
    }
}
