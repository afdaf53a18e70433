//! The units in which a toy reports what it sees, so that there is a log whose numbers are nothing like Meta-World's.

use super::OBSERVATION_DIM;
use crate::robot::Robot;

/// Units of the toy's observations; its actions have one kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Units {
    /// The table reaches from -1 to 1, and so does the gripper.
    #[default]
    Table,
    /// The table is a metre wide and reported in micrometres; the gripper in percent.
    Micrometres,
}

impl Units {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Table, Self::Micrometres];

    /// The name of the task that is flown in these units.
    #[must_use]
    pub const fn task(self) -> &'static str {
        match self {
            Self::Table => "toy",
            Self::Micrometres => "toy-micrometres",
        }
    }

    /// The units of a task; none for what is no toy.
    #[must_use]
    pub fn of_task(task: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|units| units.task() == task)
    }

    /// The robot that reports in these units.
    #[must_use]
    pub fn robot(self) -> Robot {
        let text = match self {
            Self::Table => include_str!("robot.toml"),
            Self::Micrometres => include_str!("robot-micrometres.toml"),
        };
        Robot::parse(text).expect("a test reads it")
    }

    /// What each value of an observation is multiplied by.
    #[must_use]
    pub const fn scale(self) -> [f32; OBSERVATION_DIM] {
        match self {
            Self::Table => [1.0; OBSERVATION_DIM],
            Self::Micrometres => [500_000.0, 500_000.0, 500_000.0, 500_000.0, 100.0],
        }
    }
}
