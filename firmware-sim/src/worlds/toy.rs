//! The toy: a point on a table, in this process.

use super::{Collection, Kind, Simulation};
use crate::bridge::Engine;
use crate::plants::toy::{EPISODE_STEPS, ToyPlant, Units};
use crate::robot::Robot;

/// The world of the toy, in one unit or another.
#[derive(Debug)]
pub(super) struct Toy;

fn units(task: &str) -> Units {
    Units::of_task(task).unwrap_or_default()
}

impl Kind for Toy {
    fn name(&self) -> &'static str {
        "toy"
    }

    fn about(&self) -> &'static str {
        "a point on a table, a goal and a gripper; needs no Python"
    }

    fn tasks(&self) -> Vec<&'static str> {
        Units::ALL.map(Units::task).to_vec()
    }

    fn robot(&self, task: &'static str) -> Robot {
        units(task).robot()
    }

    fn simulation(&self, task: &'static str, _engine: Engine) -> Simulation {
        Simulation::Here(Box::new(ToyPlant::in_units(units(task))))
    }

    fn collection(&self, _task: &'static str) -> Option<Collection> {
        Some(Collection {
            steps: EPISODE_STEPS,
            scene: None,
            reward: "toy",
            push: None,
            infos: 0,
        })
    }
}
