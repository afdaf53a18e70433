//! The simulator itself. The first of these tests to run installs it, if no command has before.

use std::ops::ControlFlow;
use std::process::{Command, Stdio};
use std::sync::LazyLock;
use std::time::Duration;

use firmware_sim::bridge::speed::{self, Speed};
use firmware_sim::bridge::{
    Behaviour, BridgeError, Engine, Environment, EpisodeJob, Look, PictureJob, Pool, State, Worker,
    environment,
};
use firmware_sim::plant::{Plant, PlantError};
use firmware_sim::plants::simulated::SimulatedPlant;
use firmware_sim::progress::Audience;
use firmware_sim::worlds::metaworld::tasks::TWO_INTENTIONS;

use crate::fake::bridge;
use crate::python::passes;

static ENVIRONMENT: LazyLock<Environment> =
    LazyLock::new(|| match environment::ensure(Audience::Log) {
        Ok(environment) => environment,
        Err(error) => panic!("failed to {error}"),
    });

fn job(task: &str, seed: u64, steps: u32) -> EpisodeJob {
    EpisodeJob {
        task: task.to_owned(),
        behaviour: Behaviour::PAPER_EPSILON,
        seed,
        steps,
    }
}

fn worker() -> Worker {
    Worker::spawn(&ENVIRONMENT).expect("the simulator starts")
}

#[test]
fn tasks_equal_the_package_s_own_whatever_was_played_before() {
    passes(ENVIRONMENT.python(), "test_task.py");
}

#[test]
fn a_session_tells_a_request_that_makes_no_sense_from_a_simulator_that_fails() {
    passes(ENVIRONMENT.python(), "test_session.py");
}

#[test]
fn a_recorded_episode_is_made_worse_as_its_behaviour_says() {
    passes(ENVIRONMENT.python(), "test_collect.py");
}

#[test]
fn two_intentions_in_one_scene_see_the_same_episodes_and_no_goal() {
    passes(ENVIRONMENT.python(), "test_pairs.py");
}

#[test]
fn pictures_show_recorded_states_and_leave_no_trace() {
    passes(ENVIRONMENT.python(), "test_render.py");
}

#[test]
fn a_picture_of_a_recorded_state_is_no_single_colour_and_another_state_looks_different() {
    let mut worker = worker();
    let job = job("drawer-open-v3", 3, 40);
    let episode = worker.collect(&job).expect("an episode");
    let state = |row: usize| {
        let of = |values: &[f64], width: usize| values[row * width..][..width].to_vec();
        State {
            qpos: of(&episode.qpos, episode.shape.qpos),
            mocap_pos: of(&episode.mocap_pos, 3 * episode.shape.mocap),
            mocap_quat: of(&episode.mocap_quat, 4 * episode.shape.mocap),
        }
    };
    let pictures = |look, rows: &[usize]| PictureJob {
        task: job.task.clone(),
        seed: job.seed,
        look,
        states: rows.iter().map(|&row| state(row)).collect(),
    };
    let look = Look {
        width: 160,
        height: 120,
        quality: 80,
    };
    let drawn = worker.render(&pictures(look, &[0, 40, 0]));
    let drawn = drawn.expect("Debian's libosmesa6 or libegl1 is installed");
    assert!(["egl", "osmesa", "cgl"].contains(&drawn.way.as_str()));
    let [first, last, again] = drawn.jpegs.as_slice() else {
        panic!("{} pictures", drawn.jpegs.len());
    };
    assert!(first != last && first == again);
    for jpeg in [first, last] {
        assert!(jpeg.starts_with(&[0xFF, 0xD8]) && jpeg.ends_with(&[0xFF, 0xD9]));
        // One of a single colour has 1,200 bytes at this size.
        assert!(jpeg.len() > 3000, "{} bytes", jpeg.len());
    }
    assert_eq!(
        worker.collect(&job).expect("the episode again"),
        episode,
        "pictures leave no trace"
    );
    let nothing = Look { width: 0, ..look };
    assert!(matches!(
        worker.render(&pictures(nothing, &[0])),
        Err(BridgeError::Refused { .. })
    ));
}

#[test]
fn a_flight_of_two_intentions_sees_no_goal_and_gets_one_s_reward() {
    let flown = TWO_INTENTIONS.map(|task| {
        let mut worker = worker();
        worker.open(task).expect("the task exists");
        let (first, _) = worker.reset(0, 3).expect("an episode starts");
        let step = worker.step(&[0.5, 0.5, -0.5, 0.0]).expect("a step");
        for observation in [&first, &step.observation] {
            assert_eq!(observation[36..], [0.0; 3], "{task}");
        }
        (first, step)
    });
    let mut told_apart = 0;
    for [(one, first), (other, second)] in flown.as_chunks::<2>().0 {
        assert_eq!((one, &first.observation), (other, &second.observation));
        told_apart += u32::from(first.reward != second.reward);
    }
    assert_eq!(
        told_apart, 3,
        "a push is worth the same until it moves something"
    );
}

#[test]
fn both_engines_play_all_tasks_with_the_same_bits() {
    passes(ENVIRONMENT.python(), "test_fast.py");
}

#[test]
fn both_engines_are_told_apart_by_their_name_and_by_nothing_else() {
    let reference = ENVIRONMENT.clone().with_engine(Engine::Reference);
    let job = job("coffee-pull-v3", 12, 30);
    let [fast, other] = [&*ENVIRONMENT, &reference].map(|environment| {
        let mut worker = Worker::spawn(environment).expect("the simulator starts");
        let engine = format!("engine={}", environment.engine());
        assert!(worker.versions().contains(&engine), "{}", worker.versions());
        worker.collect(&job).expect("an episode")
    });
    assert_eq!(fast, other);
}

#[test]
fn plants_in_one_simulator_fly_what_each_flies_alone() {
    let alone = |seed, value| {
        let mut plant = SimulatedPlant::new(&ENVIRONMENT, "push-v3", 12_500).expect("a plant");
        plant.reset(seed).expect("an episode");
        let outcomes: Vec<_> = (0..5)
            .map(|_| plant.apply(&[value; 4]).expect("a step"))
            .collect();
        (outcomes, plant.observe().expect("an observation"))
    };
    let mut plants = SimulatedPlant::several(&ENVIRONMENT, "push-v3", 12_500, 3).expect("plants");
    let flown = [(5, 0.5), (6, -0.5), (7, 1.0)];
    for (plant, (seed, _)) in plants.iter_mut().zip(flown) {
        plant.reset(seed).expect("an episode");
    }
    let mut outcomes = [const { Vec::new() }; 3];
    for step in 0..5 {
        // Once nobody says a word, and once not all of them do.
        for (place, (plant, (_, value))) in plants.iter_mut().zip(flown).enumerate() {
            if step > 0 && step + place != 3 {
                plant.announce(&[value; 4]).expect("it is heard");
            }
        }
        for (place, (plant, (_, value))) in plants.iter_mut().zip(flown).enumerate() {
            outcomes[place].push(plant.apply(&[value; 4]).expect("a step"));
        }
    }
    for ((plant, outcomes), (seed, value)) in plants.iter_mut().zip(outcomes).zip(flown) {
        let seen = plant.observe().expect("an observation");
        assert_eq!((outcomes, seen), alone(seed, value));
    }
}

#[test]
fn an_episode_has_the_same_bits_on_a_fresh_worker_and_on_a_used_one() {
    let job = job("sweep-into-v3", 3, 60);
    let fresh = worker().collect(&job).expect("an episode");
    let mut used = worker();
    used.collect(&self::job("drawer-open-v3", 3, 60))
        .expect("another task");
    used.collect(&self::job("sweep-into-v3", 4, 30))
        .expect("another episode");
    used.reset(0, 9)
        .expect("an episode that is not played to its end");
    assert_eq!(used.collect(&job).expect("the same episode"), fresh);
}

#[test]
fn a_shorter_episode_is_the_beginning_of_a_longer_one() {
    let mut worker = worker();
    let long = worker.collect(&job("reach-v3", 1, 40)).expect("an episode");
    let short = worker.collect(&job("reach-v3", 1, 15)).expect("an episode");
    assert_eq!(
        long.observations[..short.observations.len()],
        short.observations
    );
    assert_eq!(long.actions[..short.actions.len()], short.actions);
    assert_eq!(long.qpos[..short.qpos.len()], short.qpos);
    assert_eq!(
        short.truncations.iter().position(|truncated| *truncated),
        Some(14)
    );
}

#[test]
fn the_recorded_actions_replayed_step_by_step_give_the_recorded_episode() {
    let mut worker = worker();
    let episode = worker
        .collect(&job("drawer-open-v3", 11, 50))
        .expect("an episode");
    let (first, goal) = worker.reset(0, 11).expect("the same start");
    assert_eq!(goal, episode.goal);
    let mut observations = first;
    for (step, action) in episode.actions.chunks(4).enumerate() {
        let outcome = worker.step(action).expect("a step");
        assert_eq!(outcome.reward, episode.rewards[step]);
        assert_eq!(outcome.success, episode.success[step]);
        observations.extend(outcome.observation);
    }
    assert_eq!(observations, episode.observations);
}

#[test]
fn an_episode_has_every_array_in_its_shape() {
    let episode = worker()
        .collect(&job("hammer-v3", 2, 10))
        .expect("an episode");
    let (shape, steps, rows) = (episode.shape, 10, 11);
    assert_eq!(
        (shape.observation, shape.action, shape.horizon),
        (39, 4, 500)
    );
    assert_eq!(episode.observations.len(), rows * shape.observation);
    assert_eq!(episode.actions.len(), steps * shape.action);
    assert_eq!(episode.qpos.len(), rows * shape.qpos);
    assert_eq!(episode.qvel.len(), rows * shape.qvel);
    assert_eq!(episode.mocap_pos.len(), rows * shape.mocap * 3);
    assert_eq!(episode.goal.len(), shape.goal);
    assert!(episode.actions.iter().all(|action| action.abs() <= 1.0));
    assert!(episode.terminations.iter().all(|terminated| !terminated));
}

#[test]
fn seeds_and_behaviours_matter() {
    let mut worker = worker();
    let one = worker.collect(&job("push-v3", 1, 10)).expect("an episode");
    let other = worker.collect(&job("push-v3", 2, 10)).expect("an episode");
    assert_ne!(one.goal, other.goal);
    let expert = EpisodeJob {
        behaviour: Behaviour::EXPERT,
        ..job("push-v3", 1, 10)
    };
    let expert = worker.collect(&expert).expect("an episode");
    assert_eq!(one.goal, expert.goal);
    assert_ne!(one.actions, expert.actions);
}

#[test]
fn an_unknown_task_and_too_many_steps_are_refused() {
    let mut worker = worker();
    assert!(matches!(
        worker.open("drawer-open-v2"),
        Err(BridgeError::Refused { .. })
    ));
    assert!(matches!(
        worker.collect(&job("reach-v3", 1, 501)),
        Err(BridgeError::Refused { .. })
    ));
    assert!(matches!(
        worker.collect(&job("reach-v3", 1, 0)),
        Err(BridgeError::Refused { .. })
    ));
    assert!(
        matches!(worker.step(&[0.0; 4]), Err(BridgeError::Refused { .. })),
        "no episode is running"
    );
}

#[test]
fn two_workers_play_what_one_plays() {
    let jobs: Vec<_> = (0..5).map(|seed| job("window-open-v3", seed, 20)).collect();
    let play = |workers| {
        let mut episodes = vec![None; jobs.len()];
        let result = Pool::new(&ENVIRONMENT, workers).run(&jobs, |index, episode| {
            episodes[index] = Some(episode);
            ControlFlow::Continue(())
        });
        result.map(|()| episodes).expect("all are played")
    };
    assert_eq!(play(1), play(2));
}

#[test]
fn a_measurement_inside_python_ends_with_its_parent() {
    let mut script = Command::new(ENVIRONMENT.python())
        .arg("-Es")
        .arg(bridge().join("speed.py"))
        // Minutes of steps: it does not come to its own end.
        .args(["reach-v3", "1000000", "fast"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("it starts");
    drop(script.stdin.take());
    let output = script.wait_with_output().expect("it ends");
    assert!(output.stdout.is_empty());
}

#[test]
fn the_speed_is_that_of_the_bridge_and_of_both_ways_inside_python() {
    let speed = speed::measure(&ENVIRONMENT, "reach-v3", 20).expect("three times");
    let Speed {
        bridge,
        package,
        task,
    } = speed;
    assert!(
        [bridge, package, task]
            .iter()
            .all(|time| !time.is_zero() && *time < Duration::MAX)
    );
    assert!(speed.of_task() > 0.0 && speed.of_package() > 0.0);
}

#[test]
fn the_plant_flies_the_episode_of_its_seed() {
    let mut plant = SimulatedPlant::new(&ENVIRONMENT, "reach-v3", 12_500).expect("a plant");
    assert!(matches!(plant.observe(), Err(PlantError::NoEpisode)));
    plant.reset(5).expect("an episode");
    let first = plant.observe().expect("an observation");
    assert_eq!(
        (first.sequence, first.stamp_us, first.values.len()),
        (0, 0, 39)
    );
    assert!(matches!(
        plant.apply(&[0.0; 3]),
        Err(PlantError::ActionLength {
            expected: 4,
            actual: 3
        })
    ));
    plant.apply(&[0.5; 4]).expect("a step");
    assert_eq!(
        (
            plant.observe().expect("an observation").sequence,
            plant.now_us()
        ),
        (1, 12_500)
    );
    plant.reset(5).expect("the episode again");
    assert_eq!(plant.observe().expect("an observation"), first);
    let outcomes: Vec<_> = (0..500)
        .map(|_| plant.apply(&[0.0; 4]).expect("a step").done)
        .collect();
    assert_eq!(outcomes.iter().position(|done| *done), Some(499));
    assert!(matches!(plant.apply(&[0.0; 4]), Err(PlantError::NoEpisode)));
}
