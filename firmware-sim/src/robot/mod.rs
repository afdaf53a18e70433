//! What a robot's numbers are: `robot.toml`, which somebody who knows the robot wrote. It travels inside a dataset and becomes the
//! contract of an artefact. Nothing here is told from a shape or from data; a draft marks what it guesses, and a robot with guesses
//! in it counts as undeclared.

mod check;
mod draft;
mod role;
mod safe;
#[cfg(test)]
mod tests;

use std::fs;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use ted_policy::{ActionChannel, ActionMap, Contract, ContractFault, ObservationChannel};

pub use check::RobotFault;
pub use role::{Axis, Role};
pub use safe::OnFault;

/// Name of the file, in the folder of a dataset's arrays.
pub const ROBOT_FILE: &str = "robot.toml";

/// A robot: its channels in order, and its times.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Robot {
    /// What people call it.
    pub name: String,
    /// Time from one action to the next, in microseconds.
    pub period_us: u32,
    /// Oldest observation that may be acted on, in microseconds.
    pub max_observation_age_us: u32,
    /// Which of these are guesses.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub guessed: Vec<Fact>,
    /// What it sees, in order.
    pub observation: Vec<Sensor>,
    /// What it does, in order.
    pub action: Vec<Actuator>,
}

/// A channel of the observation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sensor {
    /// What it measures, such as `hand_x`.
    pub name: String,
    /// Its unit, such as `m`.
    #[serde(default)]
    pub unit: String,
    /// What it can read at all, lowest and highest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range: Option<[f32; 2]>,
    /// The smallest difference that means anything, in its unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub resolution: Option<f32>,
    /// What it is to somebody who looks at the robot.
    #[serde(default, skip_serializing_if = "Role::is_none")]
    pub role: Role,
    /// Which of these are guesses.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub guessed: Vec<Fact>,
}

/// A channel of the action.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Actuator {
    /// What it moves, such as `hand_dx`.
    pub name: String,
    /// Its unit, such as `cm`.
    #[serde(default)]
    pub unit: String,
    /// What may be sent, lowest and highest: a policy's -1 and 1.
    pub range: [f32; 2],
    /// Largest change from one action to the next, in its unit; none for no limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slew_per_tick: Option<f32>,
    /// What is sent once the policy no longer flies.
    pub on_fault: OnFault,
    /// Which of these are guesses.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub guessed: Vec<Fact>,
}

/// A field of a robot or of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs)]
pub enum Fact {
    Name,
    PeriodUs,
    MaxObservationAgeUs,
    Unit,
    Range,
    Resolution,
    Role,
    SlewPerTick,
    OnFault,
}

/// Why a file declares no robot.
#[derive(Debug, thiserror::Error)]
pub enum RobotError {
    /// It cannot be read.
    #[error("read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: std::io::Error,
    },
    /// It is no robot.
    #[error("{} declares no robot: {reason}", path.display())]
    Parse {
        /// The file.
        path: PathBuf,
        /// What is wrong, and in which line.
        reason: String,
    },
    /// It is one that cannot be.
    #[error("{}: {fault}", path.display())]
    Fault {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        fault: RobotFault,
    },
}

impl Robot {
    /// Reads and checks a file.
    ///
    /// # Errors
    /// When it cannot be read, is no TOML of a robot, or [`Self::check`] refuses it.
    pub fn read(path: &Path) -> Result<Self, RobotError> {
        let path_of = || path.to_path_buf();
        let text = fs::read_to_string(path).map_err(|source| RobotError::Read {
            path: path_of(),
            source,
        })?;
        let robot = Self::parse(&text).map_err(|error| RobotError::Parse {
            path: path_of(),
            reason: error.to_string().trim_end().to_owned(),
        })?;
        robot.check().map_err(|fault| RobotError::Fault {
            path: path_of(),
            fault,
        })?;
        Ok(robot)
    }

    /// The robot of a text, unchecked.
    ///
    /// # Errors
    /// When it is no TOML of a robot.
    pub fn parse(text: &str) -> Result<Self, toml::de::Error> {
        toml::from_str(text)
    }

    /// The robot as a file says it.
    #[must_use]
    pub fn to_toml(&self) -> String {
        toml::to_string(self).expect("strings, numbers and lists always serialise")
    }

    /// Whether everything in it was said by somebody who knows.
    #[must_use]
    pub fn declared(&self) -> bool {
        self.guesses().next().is_none()
    }

    /// What is guessed: the channel's name, none for what is of the whole robot, and the fact.
    pub fn guesses(&self) -> impl Iterator<Item = (Option<&str>, Fact)> {
        let of = |name, facts: &'_ [Fact]| -> Vec<_> {
            facts.iter().map(|&fact| (name, fact)).collect()
        };
        let sensors = self.observation.iter();
        let actuators = self.action.iter();
        of(None, &self.guessed)
            .into_iter()
            .chain(sensors.flat_map(move |it| of(Some(it.name.as_str()), &it.guessed)))
            .chain(actuators.flat_map(move |it| of(Some(it.name.as_str()), &it.guessed)))
    }

    /// Between a policy's numbers and the robot's, for each action channel.
    pub fn action_maps(&self) -> impl Iterator<Item = ActionMap> {
        (self.action.iter()).map(|it| ActionMap::new(it.range[0], it.range[1]))
    }

    /// What a controller may expect and promise, if it accepts these ranges of the observation, a pair for each channel.
    ///
    /// # Errors
    /// When there are more channels than the controller has room for, or a range is not finite.
    pub fn contract<'a>(
        &'a self,
        task: &'a str,
        accepted: &[[f32; 2]],
    ) -> Result<Contract<'a>, ContractFault> {
        let observation: Vec<_> = (self.observation.iter().zip(accepted))
            .map(|(sensor, &[low, high])| ObservationChannel {
                name: sensor.name.as_str().into(),
                unit: sensor.unit.as_str().into(),
                low,
                high,
            })
            .collect();
        let action: Vec<_> = self.action.iter().map(Actuator::channel).collect();
        let contract = Contract::new(
            task,
            &observation,
            &action,
            self.period_us,
            self.max_observation_age_us,
        )?;
        if self.declared() {
            Ok(contract)
        } else {
            Ok(contract.undeclared())
        }
    }
}

impl Actuator {
    /// As a contract has it.
    fn channel(&self) -> ActionChannel<'_> {
        let [low, high] = self.range;
        ActionChannel {
            name: self.name.as_str().into(),
            unit: self.unit.as_str().into(),
            low,
            high,
            slew_per_tick: self.slew_per_tick.unwrap_or(high - low),
            on_fault: self.on_fault.into(),
        }
    }
}

impl std::fmt::Display for Fact {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Name => "name",
            Self::PeriodUs => "period_us",
            Self::MaxObservationAgeUs => "max_observation_age_us",
            Self::Unit => "unit",
            Self::Range => "range",
            Self::Resolution => "resolution",
            Self::Role => "role",
            Self::SlewPerTick => "slew_per_tick",
            Self::OnFault => "on_fault",
        })
    }
}
