//! D4RL's tasks: the Python side by its own tests, and every task as a plant.

use std::path::Path;
use std::process::Command;

use firmware_sim::bridge::{Engine, environment};
use firmware_sim::plant::Plant;
use firmware_sim::progress::Audience;
use firmware_sim::worlds::{AnyPlant, LISTED, World};

#[test]
fn the_python_side_has_gymnasium_s_numbers_and_d4rl_s_maze() {
    let environment = environment::ensure(Audience::Log).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("d4rl-world/test_d4rl.py");
    let python = Command::new(environment.python())
        .arg("-Es")
        .arg(script)
        .output();
    let output = python.expect("python starts");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
}

#[test]
fn every_task_flies_its_robot_and_an_episode_is_a_function_of_its_seed() {
    let d4rl = LISTED.into_iter().find(|kind| kind.name() == "d4rl");
    for task in d4rl.unwrap().tasks() {
        let world = World::of_task(task).unwrap();
        let World::Listed(listed) = &world else {
            panic!("{task} is listed");
        };
        let robot = listed.robot();
        let ready = world.ready(Engine::default(), Audience::Log).unwrap();
        assert_eq!(ready.engine(), None);
        let mut plants = ready.plants(2, 1).unwrap();
        let action = vec![0.5; robot.action.len()];
        let play = |plant: &mut AnyPlant, seed| {
            plant.reset(seed).unwrap();
            let first = plant.observe().unwrap().values;
            assert_eq!(first.len(), robot.observation.len(), "{task}");
            let mut rewards = Vec::new();
            for _ in 0..25 {
                let outcome = plant.apply(&action).unwrap();
                rewards.push(outcome.reward_true);
                if outcome.done {
                    break;
                }
            }
            let period = u64::from(robot.period_us);
            assert_eq!(plant.now_us(), rewards.len() as u64 * period, "{task}");
            (first, rewards, plant.observe().unwrap().values)
        };
        let first = play(&mut plants[0], u64::MAX);
        assert_ne!(play(&mut plants[1], 8), first, "{task}");
        assert_eq!(play(&mut plants[1], u64::MAX), first, "{task}");
    }
}
