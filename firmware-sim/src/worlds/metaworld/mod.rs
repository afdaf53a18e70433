//! MuJoCo Meta-World: one robot, whatever the task.

pub mod tasks;

use super::{Collection, Kind, Simulation};
use crate::bridge::Engine;
use crate::bridge::environment::Program;
use crate::robot::Robot;

/// Steps of an episode. Nothing stops at success, as the paper's score asks for.
pub const EPISODE_STEPS: u32 = 500;

/// The robot of all its tasks.
#[must_use]
pub fn robot() -> Robot {
    Robot::parse(include_str!("../../../metaworld-bridge/robot.toml")).expect("a test reads it")
}

/// The world of its tasks.
#[derive(Debug)]
pub(super) struct MetaWorld;

impl Kind for MetaWorld {
    fn name(&self) -> &'static str {
        "metaworld"
    }

    fn about(&self) -> &'static str {
        "MuJoCo Meta-World v3: an arm with a gripper, 50 tasks, and tasks of two intentions in one log"
    }

    fn tasks(&self) -> Vec<&'static str> {
        [&tasks::ALL[..], &tasks::TWO_INTENTIONS].concat()
    }

    fn groups(&self) -> &'static [(&'static str, &'static [&'static str])] {
        &tasks::GROUPS
    }

    fn robot(&self, _task: &'static str) -> Robot {
        robot()
    }

    fn simulation(&self, _task: &'static str, engine: Engine) -> Simulation {
        Simulation::Worker(Program::MetaWorld(engine))
    }

    fn has_engines(&self) -> bool {
        true
    }

    fn draws(&self) -> bool {
        true
    }

    fn collection(&self, task: &'static str) -> Option<Collection> {
        Some(Collection {
            steps: EPISODE_STEPS,
            scene: tasks::scene(task),
            reward: "v2",
            pushes: true,
            infos: 64,
        })
    }
}
