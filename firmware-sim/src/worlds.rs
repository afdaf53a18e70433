//! The worlds that policies are flown in, and whose tasks are whose.

use crate::plants::metaworld;
use crate::plants::toy::Units;
use crate::robot::Robot;
use crate::tasks;

/// The robot of a task; none where the task is of no world.
#[must_use]
pub fn robot_of(task: &str) -> Option<Robot> {
    match Units::of_task(task) {
        Some(units) => Some(units.robot()),
        None => tasks::single(task).ok().map(|_| metaworld::robot()),
    }
}
