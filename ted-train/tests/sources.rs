//! From a file of every kind that `ted import` reads to a policy, a report and an ONNX file, by the commands of the README.
//!
//! Each file is made by the library that people make such files with, and the numbers that this library reads from it are those that the real
//! `minari` finds in the dataset and that the trainer learns from, to the bit. The packages are installed at locked versions into a virtual
//! environment, once, under the target folder; `TED_SOURCES_VENV` names another place for it. In `sources/`, `requirements.lock` is made
//! from `requirements.in` by
//!
//! ```sh
//! uv pip compile --universal --python-version 3.11 --generate-hashes --no-emit-index-url \
//!     --only-binary :all: --no-header -c ../../source-reader/requirements-test.lock -o requirements.lock requirements.in
//! ```

mod venv;

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use ted_policy::{Artifact, ArtifactBytes};
use ted_train::dataset::Dataset;
use ted_train::tolerance::EXPORTED;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/sources");

/// A clone that learns for a moment.
const SMALL: [&str; 4] = [
    "algorithm.hidden=[16]",
    "algorithm.batch=16",
    "algorithm.steps=20",
    "schedule.log_every=10",
];

#[test]
fn an_hdf5_file_of_d4rl() {
    goes_all_the_way("d4rl");
}

#[test]
fn an_hdf5_file_of_robomimic() {
    goes_all_the_way("robomimic");
}

#[test]
fn a_folder_of_lerobot_2() {
    goes_all_the_way("lerobot-2");
}

#[test]
fn a_folder_of_lerobot_3() {
    goes_all_the_way("lerobot-3");
}

#[test]
fn a_dataset_of_minari_in_arrow() {
    goes_all_the_way("minari-arrow");
}

#[test]
fn a_dataset_of_minari_in_hdf5() {
    goes_all_the_way("minari-hdf5");
}

#[test]
fn arrays_of_numpy() {
    goes_all_the_way("npz");
}

#[test]
fn a_table_of_numbers_with_commas() {
    goes_all_the_way("csv");
}

#[test]
fn lines_of_json() {
    goes_all_the_way("jsonl");
}

#[test]
fn an_mcap_file() {
    goes_all_the_way("mcap");
}

#[test]
fn a_rosbag2_in_sqlite() {
    goes_all_the_way("rosbag2-sqlite3");
}

#[test]
fn a_rosbag2_in_mcap() {
    goes_all_the_way("rosbag2-mcap");
}

/// Makes a log of this kind, imports it, learns from it, exports what was learned, and compares every number on the way.
fn goes_all_the_way(kind: &str) {
    let home = tempfile::tempdir().unwrap();
    let logs = home.path().join("logs");
    fs::create_dir(&logs).unwrap();
    let made = python(
        home.path(),
        "make.py",
        &[kind, &logs.display().to_string()],
        "",
    );
    let mut import = vec!["import", text(&made["source"]), "--as", "mine/logs-v0"];
    import.extend(made["options"].as_array().unwrap().iter().map(text));
    ted(home.path(), &import);

    let mut train = vec!["train", "mine/logs-v0", "--preset", "bc", "--out", "run"];
    train.extend(SMALL.iter().flat_map(|set| ["--set", set]));
    ted(home.path(), &train);
    ted(home.path(), &["report", "run"]);
    ted(home.path(), &["export", "run", "--to", "onnx"]);
    let report = fs::read_to_string(home.path().join("run/report.html")).unwrap();
    assert!(report.contains("mine/logs-v0"));

    let bytes = ArtifactBytes::from_vec(fs::read(home.path().join("run/policy.ted")).unwrap());
    let artifact = Artifact::parse(&bytes).unwrap();
    // The golden observations are some of those that were recorded.
    let seen: Vec<_> = artifact.golden().cases().map(|case| case.obs_raw).collect();
    let seen = serde_json::to_string(&seen).unwrap();
    let read = python(
        home.path(),
        "read.py",
        &["mine/logs-v0", "run/policy.onnx"],
        &seen,
    );
    assert_eq!(read["episodes"], made["episodes"]);
    is_learned_from(&home.path().join("data/mine/logs-v0"), &made["episodes"]);
    flies_as_exported(&artifact, &read["actions"]);
}

/// The trainer's own view of a dataset has these episodes.
fn is_learned_from(data: &Path, episodes: &Value) {
    let dataset = Dataset::open(data).unwrap();
    let all = |name: &str| -> Vec<u8> {
        let arrays = episodes.as_array().unwrap().iter();
        let bytes = arrays.flat_map(|episode| bytes(text(&episode[name]["hex"])));
        bytes.collect()
    };
    let lengths = episodes.as_array().unwrap().iter();
    let lengths: Vec<_> = lengths
        .map(|episode| episode["actions"]["shape"][0].as_u64().unwrap())
        .collect();
    assert_eq!(
        dataset
            .episodes()
            .iter()
            .map(|it| it.len as u64)
            .collect::<Vec<_>>(),
        lengths
    );
    assert!(dataset.glitches().is_empty());
    assert_eq!(
        bytemuck::cast_slice::<_, u8>(dataset.observations()),
        all("observations")
    );
    assert_eq!(
        bytemuck::cast_slice::<_, u8>(dataset.actions_env()),
        all("actions")
    );
    let rewards = all("rewards");
    let rewards = rewards
        .chunks_exact(8)
        .map(|it| f64::from_le_bytes(it.try_into().unwrap()) as f32);
    assert_eq!(dataset.rewards_true(), rewards.collect::<Vec<_>>());
    let flags = |it: &[bool]| it.iter().map(|&flag| u8::from(flag)).collect::<Vec<_>>();
    assert_eq!(flags(dataset.terminations()), all("terminations"));
    assert_eq!(flags(dataset.truncations()), all("truncations"));
}

/// What onnxruntime says of the golden observations are the golden actions, in the robot's units.
fn flies_as_exported(artifact: &Artifact<'_>, actions: &Value) {
    let actions: Vec<Vec<f32>> = serde_json::from_value(actions.clone()).unwrap();
    let contract = artifact.contract();
    let (mut far, mut unequal, mut compared) = (0.0_f64, 0, 0);
    for (case, actions) in artifact.golden().cases().zip(&actions) {
        let channels = contract.action.iter();
        for ((unit, channel), action) in case.action_unit.iter().zip(channels).zip(actions) {
            let (middle, half) = (
                (channel.low + channel.high) / 2.0,
                (channel.high - channel.low) / 2.0,
            );
            let golden = (middle + half * unit).clamp(channel.low, channel.high);
            far = far.max(f64::from(
                (action - golden).abs() / channel.low.abs().max(channel.high.abs()),
            ));
            unequal += u64::from(action.to_bits() != golden.to_bits());
            compared += 1;
        }
    }
    assert!(compared > 0 && compared == actions.concat().len());
    assert!(
        EXPORTED.allowed.holds(far, unequal),
        "{far:e} apart, {unequal} of {compared} unequal"
    );
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap()
}

fn bytes(hex: &str) -> Vec<u8> {
    let pairs = hex.as_bytes().chunks_exact(2);
    let digits = pairs.map(|pair| std::str::from_utf8(pair).unwrap());
    digits
        .map(|pair| u8::from_str_radix(pair, 16).unwrap())
        .collect()
}

/// Runs a command of the README in a folder.
fn ted(home: &Path, arguments: &[&str]) {
    let reader = Path::new(env!("CARGO_TARGET_TMPDIR")).join("reader");
    let output = Command::new(env!("CARGO_BIN_EXE_ted"))
        .args(arguments)
        .arg("--quiet")
        .current_dir(home)
        .env("MINARI_DATASETS_PATH", home.join("data"))
        .env("TED_READER_VENV", reader)
        .output()
        .unwrap();
    succeeded(arguments, &output);
}

/// Runs a script beside this file in the environment of the libraries, with this on its standard input, and gives the JSON that it prints.
fn python(home: &Path, script: &str, arguments: &[&str], input: &str) -> Value {
    let folder = PathBuf::from(FOLDER);
    let python = venv::python("sources", &folder.join("requirements.lock"));
    let mut child = Command::new(python)
        .arg("-B")
        .arg(folder.join(script))
        .args(arguments)
        .current_dir(home)
        .env("MINARI_DATASETS_PATH", home.join("data"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child
        .stdin
        .take()
        .unwrap()
        .write_all(input.as_bytes())
        .unwrap();
    let output = child.wait_with_output().unwrap();
    succeeded(arguments, &output);
    serde_json::from_slice(&output.stdout).unwrap()
}

#[track_caller]
fn succeeded(arguments: &[&str], output: &Output) {
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {said}");
}
