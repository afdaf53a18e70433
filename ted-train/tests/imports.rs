//! Other people's logs: the reader's own tests, against the libraries that write such files, and the way of a table to a dataset.
//!
//! The reader's packages are installed at locked versions into a virtual environment under the target folder.

mod venv;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use firmware_sim::robot::Robot;
use ted_train::dataset::Dataset;

const READER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/source-reader");
const EXAMPLE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../firmware-sim/own-world/example"
);

fn ted(home: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_ted"))
        .args(arguments)
        .arg("--quiet")
        .current_dir(home)
        .env("MINARI_DATASETS_PATH", home.join("data"))
        // Of other Python programs of the person's: nothing to the reader.
        .env("PYTHONHOME", "/nowhere")
        .env(
            "TED_READER_VENV",
            Path::new(env!("CARGO_TARGET_TMPDIR")).join("reader"),
        )
        .output()
        .unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Two episodes of three rows, whose actions lie in [0, 2].
const TABLE: &str = "\
run,t,x,v,u
a,0.0,1.5,0.25,0.5
a,0.1,1.75,0.5,2.0
a,0.2,2.0,0.75,0.0
b,0.0,-1.5,0.125,1.0
b,0.1,-1.25,0.0625,1.5
b,0.2,-1.0,0.03125,0.0
";

const MAP: &str = "\
[observation]
columns = [\"x\", \"v\"]
[action]
columns = [\"u\"]
[episode]
column = \"run\"
[time]
column = \"t\"
unit = \"s\"
";

fn home_with_table() -> (tempfile::TempDir, PathBuf) {
    let home = tempfile::tempdir().unwrap();
    fs::write(home.path().join("logs.csv"), TABLE).unwrap();
    fs::write(home.path().join("map.toml"), MAP).unwrap();
    let data = home.path().join("data/mine/logs-v0");
    (home, data)
}

#[test]
fn the_numbers_of_a_table_are_those_that_are_learned_from_and_what_nobody_said_is_a_guess() {
    let (home, data) = home_with_table();
    let import = ["import", "logs.csv", "--map", "map.toml"];
    let imported = ted(home.path(), &import);
    assert!(imported.status.success(), "{}", said(&imported));
    let dataset = Dataset::open(&data).unwrap();
    assert_eq!(dataset.episodes().len(), 2);
    // The last row of an episode has no observation after it.
    assert_eq!(
        dataset.observations(),
        [
            1.5, 0.25, 1.75, 0.5, 2.0, 0.75, -1.5, 0.125, -1.25, 0.0625, -1.0, 0.03125
        ]
    );
    assert_eq!(dataset.actions_env(), [0.5, 2.0, 1.0, 1.5]);
    assert_eq!(dataset.only_reward(), Some(0.0));
    assert_eq!(dataset.truncations(), [false, true, false, true]);
    let robot = dataset.robot();
    assert_eq!((robot.period_us, robot.declared()), (100_000, false));
    assert_eq!(robot.observation[1].name, "v");

    // Declared, it stays when the same is imported again, and whatever is whole is not written again.
    let mut declared = robot.clone();
    declared.guessed.clear();
    declared
        .observation
        .iter_mut()
        .for_each(|it| it.guessed.clear());
    for actuator in &mut declared.action {
        actuator.guessed.clear();
        actuator.range = [0.0, 2.0];
    }
    fs::write(home.path().join("robot.toml"), declared.to_toml()).unwrap();
    let output = ted(
        home.path(),
        &["robot", "declare", "mine/logs-v0", "robot.toml"],
    );
    assert!(output.status.success(), "{}", said(&output));
    let episode = data.join("data/0");
    let written = fs::metadata(&episode).unwrap().modified().unwrap();
    assert!(ted(home.path(), &import).status.success());
    assert_eq!(fs::metadata(&episode).unwrap().modified().unwrap(), written);
    let dataset = Dataset::open(&data).unwrap();
    assert_eq!(dataset.robot(), &declared);
    assert_eq!(dataset.actions(), [-0.5, 1.0, 0.0, 0.5]);
}

#[test]
fn an_action_outside_of_its_declared_range_is_refused_with_its_place_or_clipped_and_counted() {
    let (home, data) = home_with_table();
    let mut robot = Robot::draft(2, &[[0.0, 1.0]]);
    robot.period_us = 100_000;
    robot.max_observation_age_us = 200_000;
    fs::write(home.path().join("robot.toml"), robot.to_toml()).unwrap();
    let import = [
        "import",
        "logs.csv",
        "--map",
        "map.toml",
        "--robot",
        "robot.toml",
    ];
    let refused = ted(home.path(), &import);
    assert_eq!(refused.status.code(), Some(3));
    let words = said(&refused);
    assert!(words.contains("2 actions are outside of their ranges, the first is 2 of action_0 (0, 1) in episode a, step 1"), "{words}");
    assert!(!data.exists());
    let clipped = ted(home.path(), &[&import[..], &["--clip", "--json"]].concat());
    assert!(clipped.status.success(), "{}", said(&clipped));
    let report: serde_json::Value = serde_json::from_slice(&clipped.stdout).unwrap();
    assert_eq!(report["clipped"], serde_json::json!([2]));
    assert_eq!(
        Dataset::open(&data).unwrap().actions_env(),
        [0.5, 1.0, 1.0, 1.0]
    );
}

#[test]
fn what_is_wrong_with_a_source_is_said_with_the_way_out_and_nothing_is_written() {
    let (home, data) = home_with_table();
    let table = home.path().join("logs.csv");
    fs::write(&table, TABLE.replace("0.1,1.75", "0.1,nan")).unwrap();
    let refused = ted(home.path(), &["import", "logs.csv", "--map", "map.toml"]);
    assert_eq!(refused.status.code(), Some(3));
    let words = said(&refused);
    assert!(
        words.contains("episode a: step 1") && words.contains("--drop nan"),
        "{words}"
    );
    assert!(!data.exists());
    let described = ted(
        home.path(),
        &["import", "logs.csv", "--map", "map.toml", "--describe"],
    );
    assert!(described.status.success(), "{}", said(&described));
    assert!(String::from_utf8_lossy(&described.stdout).contains("csv"));
}

#[test]
fn the_example_s_logs_are_of_the_example_s_robot() {
    let home = tempfile::tempdir().unwrap();
    let example = |name: &str| format!("{EXAMPLE}/{name}");
    let logs = Command::new(
        firmware_sim::bridge::environment::interpreter()
            .unwrap()
            .path,
    )
    .args(["-B", &example("logs.py")])
    .output()
    .unwrap();
    fs::write(home.path().join("logs.csv"), logs.stdout).unwrap();
    let (map, robot) = (example("map.toml"), example("robot.toml"));
    let import = [
        "import",
        "logs.csv",
        "--map",
        &map,
        "--robot",
        &robot,
        "--as",
        "mine/puck-v0",
    ];
    let imported = ted(home.path(), &import);
    assert!(imported.status.success(), "{}", said(&imported));
    let dataset = Dataset::open(home.path().join("data/mine/puck-v0")).unwrap();
    assert_eq!(
        (dataset.episodes().len(), dataset.step_count()),
        (100, 15_000)
    );
    assert!(dataset.robot().declared());
}

/// Each file is made by the library that people make it with, and read.
#[test]
fn the_reader_passes_its_own_tests() {
    let python = venv::python(
        "reader-tests",
        &Path::new(READER).join("requirements-test.lock"),
    );
    for entry in fs::read_dir(READER).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if !(name.starts_with("test_") && name.ends_with(".py")) {
            continue;
        }
        let output = Command::new(python)
            .arg("-BEs")
            .arg(&path)
            .current_dir(READER)
            .output()
            .unwrap();
        assert!(output.status.success(), "{name}:\n{}", said(&output));
    }
}
