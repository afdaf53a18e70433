//! Whether a robot can be: every channel has a name of its own, ranges are finite and ordered, and it can stop.

use std::collections::HashSet;
use std::fmt::Display;

use ted_core::{MAX_ACTION, MAX_OBSERVATION};
use thiserror::Error;

use super::{Actuator, OnFault, Robot, Role, Sensor};

/// What is wrong with a robot, and what to do.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum RobotFault {
    /// It has no name.
    #[error("the robot has no name: give it one")]
    NoName,
    /// No channels of a kind, or more than there is room for.
    #[error(
        "{actual} {kind} channels, and a controller has room for 1 to {limit}: leave out what the policy does not need"
    )]
    Channels {
        /// Observation or action.
        kind: &'static str,
        /// How many there are.
        actual: usize,
        /// How many there may be.
        limit: usize,
    },
    /// A channel without a name.
    #[error("{kind} channel {index} (counted from 0) has no name: give it one")]
    NoChannelName {
        /// Observation or action.
        kind: &'static str,
        /// Its place.
        index: usize,
    },
    /// Two channels of one name.
    #[error("two {kind} channels are called {name:?}: give each a name of its own")]
    TwoOfAName {
        /// Observation or action.
        kind: &'static str,
        /// The name.
        name: String,
    },
    /// A number that cannot be.
    #[error("{what} of {channel} is {actual}: it must be {wanted}")]
    Number {
        /// Which number.
        what: &'static str,
        /// Of which channel, or of the robot.
        channel: String,
        /// What it is.
        actual: String,
        /// What it must be.
        wanted: &'static str,
    },
    /// Two channels hold the same coordinate.
    #[error(
        "{second} and {first} are both the {role}: a coordinate is one channel's, so give one of them another role (\"earlier\" is for what another channel was a step before)"
    )]
    TwoOfAPlace {
        /// One channel.
        first: String,
        /// The other one.
        second: String,
        /// The role of both.
        role: String,
    },
}

impl Robot {
    /// Passes when the robot can be.
    ///
    /// # Errors
    /// The first thing that is wrong.
    pub fn check(&self) -> Result<(), RobotFault> {
        if self.name.trim().is_empty() {
            return Err(RobotFault::NoName);
        }
        let positive = "more than 0 microseconds";
        if self.period_us == 0 {
            return Err(number("period_us", "the robot", 0, positive));
        }
        if self.max_observation_age_us < self.period_us {
            let wanted = "at least period_us, or every observation is too old";
            let age = self.max_observation_age_us;
            return Err(number("max_observation_age_us", "the robot", age, wanted));
        }
        let sensors = self.observation.iter().map(|it| it.name.as_str());
        names("observation", MAX_OBSERVATION, sensors)?;
        let actuators = self.action.iter().map(|it| it.name.as_str());
        names("action", MAX_ACTION, actuators)?;
        self.observation.iter().try_for_each(Sensor::check)?;
        self.action.iter().try_for_each(Actuator::check)?;
        for (index, sensor) in self.observation.iter().enumerate() {
            let mut before = self.observation[..index].iter();
            let place = matches!(sensor.role, Role::Place { .. });
            if let Some(first) = before.find(|it| place && it.role == sensor.role) {
                return Err(RobotFault::TwoOfAPlace {
                    first: first.name.clone(),
                    second: sensor.name.clone(),
                    role: sensor.role.to_string(),
                });
            }
        }
        Ok(())
    }
}

impl Sensor {
    fn check(&self) -> Result<(), RobotFault> {
        if let Some(range) = self.range {
            ordered(&self.name, range)?;
        }
        match self.resolution {
            Some(it) if !(it.is_finite() && it > 0.0) => Err(number(
                "resolution",
                &self.name,
                it,
                "finite and more than 0",
            )),
            _ => Ok(()),
        }
    }
}

impl Actuator {
    fn check(&self) -> Result<(), RobotFault> {
        ordered(&self.name, self.range)?;
        if let Some(slew) = self.slew_per_tick
            && !(slew.is_finite() && slew > 0.0)
        {
            let wanted = "finite and more than 0: leave it out for no limit";
            return Err(number("slew_per_tick", &self.name, slew, wanted));
        }
        let value = match self.on_fault {
            OnFault::Value(value) => value,
            it if it == OnFault::ZERO => 0.0,
            _ => return Ok(()),
        };
        if (self.range[0]..=self.range[1]).contains(&value) {
            Ok(())
        } else {
            let wanted = "inside the channel's range, or \"hold\"";
            Err(number("on_fault", &self.name, value, wanted))
        }
    }
}

fn names<'a>(
    kind: &'static str,
    limit: usize,
    names: impl ExactSizeIterator<Item = &'a str>,
) -> Result<(), RobotFault> {
    let actual = names.len();
    if !(1..=limit).contains(&actual) {
        return Err(RobotFault::Channels {
            kind,
            actual,
            limit,
        });
    }
    let mut seen = HashSet::new();
    for (index, name) in names.enumerate() {
        if name.trim().is_empty() {
            return Err(RobotFault::NoChannelName { kind, index });
        }
        if !seen.insert(name) {
            let name = name.to_owned();
            return Err(RobotFault::TwoOfAName { kind, name });
        }
    }
    Ok(())
}

fn ordered(name: &str, [low, high]: [f32; 2]) -> Result<(), RobotFault> {
    if low < high && (high - low).is_finite() {
        return Ok(());
    }
    let range = format!("[{low}, {high}]");
    let wanted = "two finite numbers, the lower one first, and no wider than single precision";
    Err(number("range", name, range, wanted))
}

fn number(
    what: &'static str,
    channel: &str,
    actual: impl Display,
    wanted: &'static str,
) -> RobotFault {
    RobotFault::Number {
        what,
        channel: channel.to_owned(),
        actual: actual.to_string(),
        wanted,
    }
}
