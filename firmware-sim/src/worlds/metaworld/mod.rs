//! MuJoCo Meta-World: one robot, whatever the task.

pub mod tasks;

use super::{Collection, Kind, Simulation};
use crate::bridge::Engine;
use crate::bridge::environment::Program;
use crate::robot::Robot;

/// Steps of an episode. Nothing stops at success, as the paper's score asks for.
pub const EPISODE_STEPS: u32 = 500;

/// What is added to every action of biased logs: so much that the random ones end up far from where they would, and so little that the
/// scripted policies mostly still succeed (with twice as much none of 20 noisy episodes of drawer-open does). None in the gripper: a
/// hand that cannot close makes a log of failures.
const PUSH: [f64; 4] = [0.15, -0.1, 0.05, 0.0];

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
            push: Some(PUSH),
            infos: 64,
        })
    }
}
