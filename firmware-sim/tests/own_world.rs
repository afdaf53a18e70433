//! A world of one's own: the puck of `own-world/example/`, flown by a policy that was written down, and worlds that are none.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::str::FromStr;

use firmware_sim::bridge::Engine;
use firmware_sim::plant::Plant;
use firmware_sim::progress::Audience;
use firmware_sim::robot::Robot;
use firmware_sim::worlds::{AnyPlant, OwnWorld, World};
use ted_core::{Dense, Mlp, Normaliser, Output as Activation, Policy};
use ted_policy::{ArtifactSpec, Digest, Provenance, write};

const EXAMPLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/own-world/example");
const PERIOD_US: u32 = 33_333;

fn puck() -> PathBuf {
    Path::new(EXAMPLE).join("puck.py")
}

fn plants(world: &Path, abreast: u16) -> Result<Vec<AnyPlant>, String> {
    let own = OwnWorld::from_str(&world.to_string_lossy())?;
    let ready = World::Own(own).ready(Engine::default(), Audience::Nobody);
    let ready = ready.map_err(|error| error.to_string())?;
    let plants = ready.plants(abreast, PERIOD_US);
    plants.map_err(|error| error.to_string())
}

/// What goes wrong with a world of this text when an episode is begun and a step is made.
fn wrong(text: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mine.py");
    fs::write(&file, text).unwrap();
    let tried = plants(&file, 1).and_then(|mut plants| {
        let plant = &mut plants[0];
        let begun = plant.reset(1).and_then(|()| plant.apply(&[0.0]));
        begun.map_err(|error| error.to_string())
    });
    tried.expect_err("it is none")
}

#[test]
fn an_episode_is_a_function_of_its_seed_and_runs_beside_others() {
    let mut plants = plants(&puck(), 2).unwrap();
    let play = |plant: &mut AnyPlant, seed, action: [f32; 2]| {
        plant.reset(seed).unwrap();
        let mut rewards = Vec::new();
        loop {
            let outcome = plant.apply(&action).unwrap();
            rewards.push(outcome.reward_true);
            if outcome.done {
                return (rewards, plant.observe().unwrap().values, plant.now_us());
            }
        }
    };
    let first = play(&mut plants[0], 7, [0.75, 0.25]);
    assert_eq!((first.0.len(), first.2), (150, 150 * u64::from(PERIOD_US)));
    let other = play(&mut plants[1], 8, [0.75, 0.25]);
    assert_ne!(first.1, other.1);
    assert_eq!(play(&mut plants[1], 7, [0.75, 0.25]), first);
    assert!(plants[0].apply(&[0.0; 2]).is_err(), "the episode is over");
}

/// Steers as the example's own pilot does: `goal - place`, less the speed.
fn steering() -> Vec<u8> {
    #[rustfmt::skip]
    let weights = [
        -3.0, 0.0, -1.6, 0.0, 3.0, 0.0,
        0.0, -3.0, 0.0, -1.6, 0.0, 3.0,
    ];
    let layer = Dense::new(6, 2, &weights, &[0.0; 2]).unwrap();
    let normaliser = Normaliser::new(&[0.0; 6], &[1.0; 6]).unwrap();
    let robot = Robot::read(&Path::new(EXAMPLE).join("robot.toml")).unwrap();
    write(&ArtifactSpec {
        contract: robot.contract("puck", &[[-9.0, 9.0]; 6]).unwrap(),
        provenance: Provenance {
            trainer_version: "0.1.0",
            preset: "written-down",
            seed: 0,
            steps: 0,
            config_digest: Digest::default(),
            dataset_id: "own/puck-v0",
            dataset_digest: Digest::default(),
            preferences_digest: None,
            dataset_return_mean: 0.0,
            dataset_return_max: 0.0,
        },
        policy: Policy::new(normaliser, Mlp::new(&[layer], Activation::Tanh).unwrap()).unwrap(),
        reward: None,
        ted: None,
        integers: None,
        golden_obs_raw: &[0.5; 6],
    })
    .unwrap()
}

fn fly(policy: &Path, options: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_firmware-sim"))
        .arg("fly")
        .arg(policy)
        .args(options)
        .args(["--quiet", "--json", "--episodes", "8"])
        .output()
        .unwrap()
}

#[test]
fn a_policy_with_actions_from_0_to_1_flies_there_at_30_hz_without_a_fault() {
    let folder = tempfile::tempdir().unwrap();
    let policy = folder.path().join("puck.ted");
    fs::write(&policy, steering()).unwrap();
    let puck = puck();
    let flown = fly(&policy, &["--world", &puck.to_string_lossy()]);
    let said = String::from_utf8_lossy(&flown.stderr).into_owned();
    assert!(flown.status.success(), "{said}");
    let report: serde_json::Value = serde_json::from_slice(&flown.stdout).unwrap();
    assert_eq!(report["faulted"], 0, "{report}");
    assert_eq!(report["plant"], "puck.py");
    assert!(report["success_rate"].as_f64().unwrap() > 0.9, "{report}");

    let other = folder.path().join("slower.py");
    let text = fs::read_to_string(&puck).unwrap();
    fs::write(
        &other,
        text.replace("period_us = 33333", "period_us = 50000"),
    )
    .unwrap();
    let flown = fly(&policy, &["--world", &other.to_string_lossy()]);
    assert_eq!(flown.status.code(), Some(3));
    let said = String::from_utf8_lossy(&flown.stderr).into_owned();
    assert!(
        said.contains("take 50000 microseconds (period_us), and the policy acts every 33333"),
        "{said}"
    );

    let flown = fly(&policy, &["--world", "nowhere.py"]);
    assert_eq!(flown.status.code(), Some(2));
    let said = String::from_utf8_lossy(&flown.stderr).into_owned();
    assert!(said.contains("there is no file nowhere.py"), "{said}");
}

const WORLD: &str = "
steps = 3
actions = 1
def make(): return None
def reset(world, seed): return [0.0, 1.0]
def step(world, action): return [0.0, 1.0], 0.0
";

#[test]
fn what_is_no_world_says_what_is_missing_in_the_file_s_own_terms() {
    let cases = [
        (
            WORLD.replace("def step", "def walk"),
            "mine.py has no function step",
        ),
        (
            WORLD.replace("steps = 3", ""),
            "mine.py must say `steps = 2` or the like",
        ),
        (
            WORLD.replace("actions = 1", "actions = 0"),
            "mine.py must say `actions = 2` or the like",
        ),
        (
            WORLD.replace("return [0.0, 1.0], 0.0", "return [0.0], 0.0"),
            "the observation of step() has 1 numbers, and had 2 before",
        ),
        (
            WORLD.replace("return [0.0, 1.0], 0.0", "return [0.0, 1.0], float('nan')"),
            "the reward of step() is not finite",
        ),
        (
            WORLD.replace("return [0.0, 1.0], 0.0", "return ([0.0, 1.0],)"),
            "step() gave 1 things",
        ),
        (
            WORLD.replace("return [0.0, 1.0], 0.0", "raise KeyError('motor')"),
            "KeyError: 'motor'",
        ),
        (
            format!("import no_such_package\n{WORLD}"),
            "no_such_package",
        ),
        (
            WORLD.replace("return [0.0, 1.0]\n", "return None\n"),
            "the first observation is NoneType",
        ),
    ];
    for (text, expected) in cases {
        let said = wrong(&text);
        assert!(said.contains(expected), "{expected}:\n{said}");
    }
}

#[test]
fn what_a_world_prints_disturbs_nobody() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("talker.py");
    fs::write(
        &file,
        WORLD.replace(
            "def make(): ",
            "print('hello')\ndef make(): print('made'); ",
        ),
    )
    .unwrap();
    let mut plants = plants(&file, 1).unwrap();
    plants[0].reset(3).unwrap();
    assert!(plants[0].apply(&[0.0]).is_ok());
}
