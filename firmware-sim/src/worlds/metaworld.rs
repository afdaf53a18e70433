//! MuJoCo Meta-World: one robot, whatever the task.

use crate::robot::Robot;

/// The robot of all its tasks.
#[must_use]
pub fn robot() -> Robot {
    Robot::parse(include_str!("../../metaworld-bridge/robot.toml")).expect("a test reads it")
}
