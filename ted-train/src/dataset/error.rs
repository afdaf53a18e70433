//! Everything that can be wrong with a dataset, each as what, where, and the way out.

use super::Shape;
use firmware_sim::robot::{Robot, RobotError};
use firmware_sim::size::Size;
use std::io;
use std::path::PathBuf;

/// Why a dataset was refused. `place` is a file, or an episode of a dataset built in memory.
#[derive(Debug, thiserror::Error)]
pub enum DatasetError {
    /// Nothing at this path.
    #[error("no dataset at {path}: collect one with `ted collect`, or correct the path")]
    NotFound {
        /// Where it was looked for.
        path: PathBuf,
    },
    /// Logs of another program.
    #[error("{path} is {what}, and no dataset yet: `ted import {path}{options}` makes one of it")]
    NotImported {
        /// The file or folder.
        path: PathBuf,
        /// What it is.
        what: &'static str,
        /// What the command needs besides.
        options: &'static str,
    },
    /// A folder without `metadata.json`.
    #[error(
        "no metadata.json in {path}: either this is not a Minari dataset, or its collection has not finished; \
         the same `ted collect` command goes on where it was"
    )]
    MissingMetadata {
        /// The data folder.
        path: PathBuf,
    },
    /// A file that cannot be read.
    #[error("cannot read {path}: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A metadata file that does not say what it must.
    #[error(
        "{path} is not valid Minari metadata: {reason}; restore the file or collect the dataset again"
    )]
    Metadata {
        /// The file.
        path: PathBuf,
        /// What is wrong in it.
        reason: String,
    },
    /// A list of videos that does not say what it must.
    #[error(
        "{path} does not name the videos of the logs: {reason}; import the logs again with `ted import`"
    )]
    Videos {
        /// The file.
        path: PathBuf,
        /// What is wrong in it.
        reason: String,
    },
    /// A storage format this reader does not know.
    #[error(
        "{path} is stored as {format}, and only arrow is read as it is: `ted import {path}` makes such a dataset of it"
    )]
    Format {
        /// The data folder.
        path: PathBuf,
        /// The format its metadata names.
        format: String,
    },
    /// An observation or action space that is not a flat box.
    #[error(
        "{space} of {path} is {actual}, expected a Box with one dimension; `ted import FOLDER --observations KEYS` makes one of a dictionary, and \
         whatever else it is must be flattened first"
    )]
    Space {
        /// The metadata file.
        path: PathBuf,
        /// `observation_space` or `action_space`.
        space: &'static str,
        /// What it is instead.
        actual: String,
    },
    /// An episode that the metadata promises and the disk does not have.
    #[error(
        "episode {episode} of {total} is missing: no {path}; restore it from a copy, or run the `ted collect` command of this \
         dataset again, which fills what is missing"
    )]
    MissingEpisode {
        /// Its index.
        episode: u32,
        /// How many the metadata promises.
        total: u32,
        /// The file that should be there.
        path: PathBuf,
    },
    /// A file whose bytes are not what was written.
    #[error(
        "{place} is damaged: {reason}; restore it from a copy, or delete its folder and run `ted collect` again"
    )]
    Damaged {
        /// The file.
        place: String,
        /// How that shows.
        reason: String,
    },
    /// A column that training needs.
    #[error("{place} has no column `{column}`; {}", way_out(column))]
    MissingColumn {
        /// The file.
        place: String,
        /// The column.
        column: &'static str,
    },
    /// An array of the wrong length, width or type.
    #[error(
        "{array} of {place}: expected {expected}, got {actual}; the recording is inconsistent and must be repaired or left out"
    )]
    WrongShape {
        /// The file or episode.
        place: String,
        /// The array.
        array: String,
        /// What was asked for.
        expected: String,
        /// What is there.
        actual: String,
    },
    /// A NaN or an infinity.
    #[error(
        "{array} of {place} holds {value} at row {row}, column {column}; every value must be finite: repair the episode or leave it out; \
         `ted import FOLDER --drop nan` keeps what comes before"
    )]
    NotFinite {
        /// The file or episode.
        place: String,
        /// The array.
        array: &'static str,
        /// Row inside the episode.
        row: usize,
        /// Column inside the row.
        column: usize,
        /// The value as it prints.
        value: f64,
    },
    /// An action outside its range.
    #[error(
        "actions of {place} holds {value} at row {row}, channel {channel}, whose range is [{}, {}]; declare what the robot may be sent: \
         `ted robot draft DATASET` writes its file, `ted robot declare` puts it into the dataset", range[0], range[1]
    )]
    ActionRange {
        /// The file or episode.
        place: String,
        /// Step inside the episode.
        row: usize,
        /// Which channel of the action.
        channel: String,
        /// The value.
        value: f32,
        /// The channel's range.
        range: [f32; 2],
        /// The robot that says so.
        robot: Box<Robot>,
    },
    /// The robot's file in the dataset's folder.
    #[error("{0}")]
    Robot(#[from] RobotError),
    /// A robot of other widths than the dataset's.
    #[error(
        "the robot {robot:?} has {} observation and {} action channels, and {path} has {} and {}: it is not the robot that was recorded, \
         or its file lacks a channel", declared.observation, declared.action, recorded.observation, recorded.action
    )]
    OtherRobot {
        /// The robot's name.
        robot: String,
        /// The dataset's folder of arrays.
        path: PathBuf,
        /// The robot's widths.
        declared: Shape,
        /// The dataset's.
        recorded: Shape,
    },
    /// An end inside of an episode.
    #[error("{place} has {flag} at step {step} of {steps}, and goes on; {}", way_out_of_an_end(*ends))]
    EndInside {
        /// The file or episode.
        place: String,
        /// `a termination` or `a truncation`.
        flag: &'static str,
        /// Step inside the episode, from 0.
        step: usize,
        /// Steps of the episode.
        steps: usize,
        /// Whether its last step has a flag too.
        ends: bool,
    },
    /// An episode without a single step.
    #[error("{place} has no steps; leave the episode out of the dataset")]
    EmptyEpisode {
        /// The file or episode.
        place: String,
    },
    /// A dataset without a single episode.
    #[error("the dataset {id} has no episodes; collect some with `ted collect`")]
    NoEpisodes {
        /// The dataset's id.
        id: String,
    },
    /// A dataset larger than the index types.
    #[error(
        "the dataset {id} has {steps} steps, more than the {limit} that one dataset may have; split it"
    )]
    TooLarge {
        /// The dataset's id.
        id: String,
        /// How many it has.
        steps: u64,
        /// How many it may have.
        limit: u64,
    },
    /// A dataset larger than the memory.
    #[error(
        "the dataset {id} takes about {needed} of memory, and {free} are free: end other programs, or make a smaller one of it"
    )]
    NoMemory {
        /// The dataset's id.
        id: String,
        /// What it takes.
        needed: Size,
        /// What there is.
        free: Size,
    },
    /// A dataset id that Minari would refuse.
    #[error("`{id}` is not a dataset id: {reason}; write it as namespace/name-v0")]
    Id {
        /// The id.
        id: String,
        /// What is wrong with it.
        reason: &'static str,
    },
}

/// What to do about an end inside of an episode.
fn way_out_of_an_end(last_step_has_one: bool) -> &'static str {
    match last_step_has_one {
        true => "it is two recordings in one: `ted import FOLDER --drop after-end` keeps the first",
        false => {
            "its last step has none, so its rows are not in the order of time, as a writer with threads leaves them: write them again in \
             order, or, if another recording follows there, leave it out with `ted import FOLDER --drop after-end`"
        }
    }
}

/// What to do about a column that is missing.
fn way_out(column: &str) -> &'static str {
    match column {
        "rewards" => {
            "logs without rewards must have 0 there, and are trained on with answers of your own (--preferences)"
        }
        _ => "the dataset must be recorded with it",
    }
}
