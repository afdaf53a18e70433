//! Declaring the robot of a dataset: a draft with what the logs say beside every guess, and what of the logs contradicts a file.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use firmware_sim::disk::{self, WriteError};
use firmware_sim::robot::{Fact, OnFault, ROBOT_FILE, Robot};
use serde::Serialize;

use crate::dataset::{Dataset, DatasetError};

/// Why a robot was not drafted or declared.
#[derive(Debug, thiserror::Error)]
pub enum DeclareError {
    /// The dataset cannot be opened, as it is or as one of this robot.
    #[error(transparent)]
    Dataset(#[from] DatasetError),
    /// The robot has guesses in it.
    #[error(
        "{guesses} facts of {} are guesses, the first is {first}: correct what is wrong, and take away the lines `guessed = ...`", path.display()
    )]
    Guesses {
        /// The robot's file.
        path: PathBuf,
        /// How many.
        guesses: usize,
        /// One of them.
        first: String,
    },
    /// The disk.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// What a robot's file is to a dataset.
#[derive(Clone, Debug, Serialize)]
pub struct Fit {
    /// Observation channels that leave their declared range in the logs.
    pub outside: Vec<Outside>,
    /// Whether the robot changes what is learned: the ranges of actions are others.
    pub changes_actions: bool,
}

/// A channel that left its declared range.
#[derive(Clone, Debug, Serialize)]
pub struct Outside {
    /// The channel.
    pub channel: String,
    /// Its declared range.
    pub range: [f32; 2],
    /// Lowest and highest value of the logs.
    pub logs: [f32; 2],
}

/// Opens the dataset at `path` for a draft: where nobody declared anything, an action may be as large as it is.
///
/// # Errors
/// When the dataset cannot be read.
pub fn open_for_draft(path: &Path) -> Result<Dataset, DatasetError> {
    match Dataset::open(path) {
        Err(DatasetError::ActionRange { robot, .. }) if !robot.declared() => {
            let mut robot = *robot;
            for actuator in &mut robot.action {
                actuator.range = [0.25 * f32::MIN, 0.25 * f32::MAX];
            }
            let dataset = Dataset::open_as(path, robot.clone())?;
            for (channel, actuator) in robot.action.iter_mut().enumerate() {
                let [low, high] = span(dataset.actions_env(), dataset.action_dim(), channel);
                actuator.range = if low < high {
                    [low, high]
                } else {
                    [low, low + 1.0]
                };
                actuator.on_fault = match (low..=high).contains(&0.0) {
                    true => OnFault::ZERO,
                    false => OnFault::HOLD,
                };
            }
            Dataset::open_as(path, robot)
        }
        opened => opened,
    }
}

/// The robot of a dataset as a file for a person to correct, with what the logs say beside every channel.
#[must_use]
pub fn draft(dataset: &Dataset) -> String {
    let robot = dataset.robot();
    let mut text = format!("# The robot of {}.\n", dataset.id());
    if !robot.declared() {
        text.push_str(HOW_TO);
    }
    let head = Head {
        name: &robot.name,
        period_us: robot.period_us,
        max_observation_age_us: robot.max_observation_age_us,
        guessed: &robot.guessed,
    };
    let _ = write!(text, "\n{}", block(&head));
    let seen = (dataset.observations(), dataset.observation_dim());
    for (channel, sensor) in robot.observation.iter().enumerate() {
        let _ = write!(
            text,
            "\n[[observation]]{}\n{}",
            logs(seen, channel),
            block(sensor)
        );
    }
    let done = (dataset.actions_env(), dataset.action_dim());
    for (channel, actuator) in robot.action.iter().enumerate() {
        let _ = write!(
            text,
            "\n[[action]]{}\n{}",
            logs(done, channel),
            block(actuator)
        );
    }
    text
}

/// What a robot that can be is to a dataset.
///
/// # Errors
/// When it has other widths, or an action leaves its range.
pub fn fit(path: &Path, robot: &Robot) -> Result<Fit, DatasetError> {
    let dataset = Dataset::open_as(path, robot.clone())?;
    let outside = robot.observation.iter().enumerate();
    let outside = outside.filter_map(|(channel, sensor)| {
        let range = sensor.range?;
        let logs = span(dataset.observations(), dataset.observation_dim(), channel);
        (logs[0] < range[0] || logs[1] > range[1]).then(|| Outside {
            channel: sensor.name.clone(),
            range,
            logs,
        })
    });
    let before = open_for_draft(path)?;
    Ok(Fit {
        outside: outside.collect(),
        changes_actions: before.digest() != dataset.digest(),
    })
}

/// Puts a robot into the dataset at `folder`, which is then one of this robot. `file` is where a person wrote it.
///
/// # Errors
/// When there are guesses in it, it does not fit the dataset, or the disk fails.
pub fn declare(folder: &Path, robot: &Robot, file: &Path) -> Result<Fit, DeclareError> {
    if let Some((channel, fact)) = robot.guesses().next() {
        return Err(DeclareError::Guesses {
            path: file.to_path_buf(),
            guesses: robot.guesses().count(),
            first: guess_text(channel, fact),
        });
    }
    let fit = fit(folder, robot)?;
    let place = crate::dataset::minari::data_folder(folder)?.join(ROBOT_FILE);
    disk::replace(&place, robot.to_toml().as_bytes())?;
    Ok(fit)
}

/// A guess in words.
#[must_use]
pub fn guess_text(channel: Option<&str>, fact: Fact) -> String {
    format!("{fact} of {}", channel.unwrap_or("the robot"))
}

const HOW_TO: &str = "\
# A draft: whatever stands in a line `guessed = [...]` nobody has said yet. Correct it, and take the line away; a robot with
# guesses in it is undeclared, and no device flies its policies. Ranges of actions are a policy's -1 and 1. Roles are \"x of hand\"
# (x, y or z of any point; the first point acts, the point \"goal\" is where something is to go), \"angle\", \"gripper\", \"velocity\",
# \"earlier\" (another channel a step before) and \"none\". on_fault is \"zero\", \"hold\" or a number. Optional: slew_per_tick of an
# action; of an observation range (what it can read at all) and resolution (the smallest difference that means anything).
";

/// What a robot's file begins with.
#[derive(Serialize)]
struct Head<'a> {
    name: &'a str,
    period_us: u32,
    max_observation_age_us: u32,
    #[serde(skip_serializing_if = "<[Fact]>::is_empty")]
    guessed: &'a [Fact],
}

fn block(part: &impl Serialize) -> String {
    toml::to_string(part).expect("strings, numbers and lists always serialise")
}

fn logs((values, width): (&[f32], usize), channel: usize) -> String {
    let [low, high] = span(values, width, channel);
    format!("        # in the logs: {low} to {high}")
}

/// The lowest and the highest value of a column.
fn span(values: &[f32], width: usize, channel: usize) -> [f32; 2] {
    let column = values.iter().skip(channel).step_by(width);
    column.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], &value| {
        [low.min(value), high.max(value)]
    })
}
