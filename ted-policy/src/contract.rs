//! The contract between a policy and whatever it is connected to: channels, units, ranges, timing.

use core::fmt;

use heapless::Vec;
use serde::{Deserialize, Serialize};
use ted_core::{MAX_ACTION, MAX_OBSERVATION};

use crate::action_map::ActionMap;
use crate::metadata::{self, Terms};
use crate::text::Text;

/// One channel of the raw observation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ObservationChannel<'a> {
    /// What it measures, such as `hand_x`.
    #[serde(borrow)]
    pub name: Text<'a>,
    /// Its unit, such as `m`.
    pub unit: Text<'a>,
    /// Smallest value a controller accepts.
    pub low: f32,
    /// Largest value a controller accepts.
    pub high: f32,
}

/// One channel of the action.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ActionChannel<'a> {
    /// What it moves, such as `hand_dx`.
    #[serde(borrow)]
    pub name: Text<'a>,
    /// Its unit, such as `cm`.
    pub unit: Text<'a>,
    /// Smallest value a controller sends, which stands for the policy's -1.
    pub low: f32,
    /// Largest value a controller sends, which stands for the policy's 1.
    pub high: f32,
    /// Largest change from one tick to the next, in the channel's unit.
    pub slew_per_tick: f32,
    /// What is sent once the policy no longer flies.
    pub on_fault: SafeAction,
}

impl ActionChannel<'_> {
    /// Between the policy's numbers and the robot's.
    #[must_use]
    pub const fn map(&self) -> ActionMap {
        ActionMap::new(self.low, self.high)
    }
}

/// What an action channel is sent while a fault is latched.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SafeAction {
    /// Zero: a motion stops.
    Zero,
    /// What was sent last: a gripper keeps its grip.
    HoldLast,
    /// This, in the channel's unit: a valve opens, a motor idles.
    Value(f32),
}

/// What a policy expects of the world, and what it promises.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Contract<'a> {
    /// The task it was trained for.
    pub task: &'a str,
    /// The raw observation, in order.
    #[serde(borrow)]
    pub observation: Vec<ObservationChannel<'a>, MAX_OBSERVATION>,
    /// The action, in order.
    #[serde(borrow)]
    pub action: Vec<ActionChannel<'a>, MAX_ACTION>,
    /// Time between two ticks, in microseconds.
    pub control_period_us: u32,
    /// Oldest observation a controller acts on, in microseconds.
    pub max_observation_age_us: u32,
    /// Whether somebody declared the robot. Where nobody did, names, units and times stand for nothing: the policy can be shown
    /// recordings, and no device flies it.
    pub declared: bool,
}

impl<'a> Contract<'a> {
    /// Joins the channels of a declared robot and checks that the contract can be kept.
    ///
    /// # Errors
    /// When a list is empty or too long, a name is empty, a range is not finite and ordered, a slew limit is not
    /// positive, a channel is to stop at a value that it may not be sent, or the control period is zero.
    pub fn new(
        task: &'a str,
        observation: &[ObservationChannel<'a>],
        action: &[ActionChannel<'a>],
        control_period_us: u32,
        max_observation_age_us: u32,
    ) -> Result<Self, ContractFault> {
        let contract = Self {
            task,
            observation: Vec::from_slice(observation).map_err(|_| {
                ContractFault::ObservationChannels {
                    limit: MAX_OBSERVATION,
                    actual: observation.len(),
                }
            })?,
            action: Vec::from_slice(action).map_err(|_| ContractFault::ActionChannels {
                limit: MAX_ACTION,
                actual: action.len(),
            })?,
            control_period_us,
            max_observation_age_us,
            declared: true,
        };
        contract.check()?;
        Ok(contract)
    }

    /// The same of a robot that nobody declared.
    #[must_use]
    pub fn undeclared(self) -> Self {
        Self {
            declared: false,
            ..self
        }
    }

    pub(crate) fn check(&self) -> Result<(), ContractFault> {
        metadata::check(
            self.task.into(),
            self.observation.iter().copied(),
            self.action.iter().copied(),
            self.control_period_us,
        )
    }

    /// The contract of an artefact, its channels copied.
    pub(crate) fn of(terms: &Terms<'a>) -> Self {
        let mut contract = Self {
            task: terms.task.as_str(),
            observation: Vec::new(),
            action: Vec::new(),
            control_period_us: terms.control_period_us,
            max_observation_age_us: terms.max_observation_age_us,
            declared: terms.declared,
        };
        // There is room: the lists are no longer.
        for channel in terms.observation.iter() {
            contract.observation.push(channel).ok();
        }
        for channel in terms.action.iter() {
            contract.action.push(channel).ok();
        }
        contract
    }
}

/// What is wrong with a contract.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ContractFault {
    /// The task has no name.
    Task,
    /// There is no observation channel, or more than there is room for.
    ObservationChannels {
        /// The most there can be.
        limit: usize,
        /// How many there are.
        actual: usize,
    },
    /// There is no action channel, or more than there is room for.
    ActionChannels {
        /// The most there can be.
        limit: usize,
        /// How many there are.
        actual: usize,
    },
    /// An observation channel has no name, or a range that is not finite and ordered.
    Observation {
        /// Which channel.
        channel: usize,
    },
    /// An action channel has no name, a range that is not finite and ordered, or no positive slew limit.
    Action {
        /// Which channel.
        channel: usize,
    },
    /// An action channel is to be sent a value on a fault that is outside its range.
    NoSafeAction {
        /// Which channel.
        channel: usize,
    },
    /// The control period is zero.
    ControlPeriod,
}

impl fmt::Display for ContractFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Task => f.write_str("the task has no name"),
            Self::ObservationChannels { limit, actual } => {
                write!(f, "{actual} observation channels, not 1 to {limit}")
            }
            Self::ActionChannels { limit, actual } => {
                write!(f, "{actual} action channels, not 1 to {limit}")
            }
            Self::Observation { channel } => {
                write!(
                    f,
                    "observation channel {channel} needs a name and a finite range with low <= high"
                )
            }
            Self::Action { channel } => write!(
                f,
                "action channel {channel} needs a name, a range of finite width with low < high and a positive slew limit"
            ),
            Self::NoSafeAction { channel } => write!(
                f,
                "action channel {channel} stops at a value outside its range: widen the range, or stop at another value or the last one sent"
            ),
            Self::ControlPeriod => f.write_str("the control period is zero"),
        }
    }
}

impl core::error::Error for ContractFault {}
