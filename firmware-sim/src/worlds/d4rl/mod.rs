//! D4RL's locomotion tasks of the paper's Section 4.3, simulated by MuJoCo: whoever has D4RL's files flies what is learned from them.

use super::{Kind, Simulation};
use crate::bridge::Engine;
use crate::bridge::environment::Program;
use crate::robot::Robot;

macro_rules! world_file {
    ($name:literal) => {
        include_str!(concat!("../../../d4rl-world/", $name))
    };
}

/// The files of its worker.
const FILES: [(&str, &str); 3] = [
    ("d4rl_worker.py", world_file!("d4rl_worker.py")),
    ("locomotion.py", world_file!("locomotion.py")),
    ("antmaze.py", world_file!("antmaze.py")),
];

/// A task: its name, the file of its robot, and the returns that D4RL's scores of 0 and 1 stand for (`d4rl/infos.py` of D4RL: those of
/// a random policy and of an expert).
struct Row {
    task: &'static str,
    robot: &'static str,
    yardstick: [f64; 2],
}

const HOPPER: &str = world_file!("hopper.toml");
const HALFCHEETAH: &str = world_file!("halfcheetah.toml");
const WALKER2D: &str = world_file!("walker2d.toml");
const ANT: &str = world_file!("ant.toml");
const ANTMAZE: &str = world_file!("antmaze.toml");

const fn row(task: &'static str, robot: &'static str, yardstick: [f64; 2]) -> Row {
    Row {
        task,
        robot,
        yardstick,
    }
}

const ROWS: [Row; 7] = [
    row("hopper", HOPPER, [-20.272_305, 3234.3]),
    row("halfcheetah", HALFCHEETAH, [-280.178_953, 12_135.0]),
    row("walker2d", WALKER2D, [1.629_008, 4592.3]),
    row("ant", ANT, [-325.6, 3879.7]),
    row("antmaze-umaze", ANTMAZE, [0.0, 1.0]),
    row("antmaze-medium", ANTMAZE, [0.0, 1.0]),
    row("antmaze-large", ANTMAZE, [0.0, 1.0]),
];

fn of(task: &str) -> &'static Row {
    let found = ROWS.iter().find(|row| row.task == task);
    found.expect("a task of this world has a row")
}

/// The world of these tasks.
#[derive(Debug)]
pub(super) struct D4rl;

impl Kind for D4rl {
    fn name(&self) -> &'static str {
        "d4rl"
    }

    fn about(&self) -> &'static str {
        "D4RL's hopper, halfcheetah, walker2d, ant and antmaze, for logs that `ted import` reads; scores are D4RL's"
    }

    fn tasks(&self) -> Vec<&'static str> {
        ROWS.iter().map(|row| row.task).collect()
    }

    fn robot(&self, task: &'static str) -> Robot {
        Robot::parse(of(task).robot).expect("a test reads it")
    }

    fn simulation(&self, task: &'static str, _engine: Engine) -> Simulation {
        Simulation::Worker(Program::Worker {
            name: "d4rl",
            files: &FILES,
            script: "d4rl_worker.py",
            task,
        })
    }

    fn yardstick(&self, task: &'static str) -> Option<[f64; 2]> {
        Some(of(task).yardstick)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_task_has_a_robot_that_is_declared() {
        let sizes = [
            ("hopper", 11, 3),
            ("halfcheetah", 17, 6),
            ("walker2d", 17, 6),
            ("ant", 27, 8),
            ("antmaze-umaze", 29, 8),
            ("antmaze-medium", 29, 8),
            ("antmaze-large", 29, 8),
        ];
        for (task, observation, action) in sizes {
            let robot = D4rl.robot(task);
            assert!(robot.declared(), "{task}");
            assert_eq!(
                (robot.observation.len(), robot.action.len()),
                (observation, action),
                "{task}"
            );
        }
        assert_eq!(D4rl.tasks(), sizes.map(|(task, ..)| task));
    }
}
