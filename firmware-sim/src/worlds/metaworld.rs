//! MuJoCo Meta-World: one robot, whatever the task.

use crate::robot::Robot;

/// Steps of an episode. Nothing stops at success, as the paper's score asks for.
pub const EPISODE_STEPS: u32 = 500;

/// The robot of all its tasks.
#[must_use]
pub fn robot() -> Robot {
    Robot::parse(include_str!("../../metaworld-bridge/robot.toml")).expect("a test reads it")
}
