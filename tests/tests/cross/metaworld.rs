//! The commands on the real simulator, which the first of them installs if none has before.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use serde_json::Value;
use ted_train::tolerance::{SCORED_F32, SCORED_INTEGER};

use crate::binaries::{command, said};

const TASK: &str = "reach-v3";

fn collect(root: &Path, episodes: &str, workers: &str) -> Command {
    let mut collect = command("ted");
    collect.args([
        "collect",
        "--task",
        TASK,
        "--episodes",
        episodes,
        "--workers",
        workers,
    ]);
    collect.args(["--json", "--root"]).arg(root);
    collect
}

fn dataset(root: &Path, episodes: &str) -> PathBuf {
    root.join(format!("ted/{TASK}-paper-n{episodes}-s0-v0"))
}

/// Every file below a folder with its bytes, locks aside.
fn contents(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if !path.ends_with(".writer.lock") {
                let bytes = fs::read(&path).unwrap();
                files.push((path.strip_prefix(folder).unwrap().to_path_buf(), bytes));
            }
        }
    }
    files.sort();
    files
}

#[test]
fn a_killed_collection_goes_on_to_the_bytes_of_one_that_was_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let (straight, killed) = (folder.path().join("straight"), folder.path().join("killed"));
    said(&mut collect(&straight, "4", "2"), &[0]);

    let mut child = collect(&killed, "4", "1")
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let first = dataset(&killed, "4").join("data/0");
    while !first.exists() && child.try_wait().unwrap().is_none() {
        // Looks again after a moment; how long it is changes nothing.
        std::thread::park_timeout(Duration::from_millis(1));
    }
    child.kill().unwrap();
    assert_eq!(child.wait().unwrap().code(), None, "killed before its end");
    assert!(!dataset(&killed, "4").join("data/metadata.json").exists());

    let report: Value = serde_json::from_str(&said(&mut collect(&killed, "4", "2"), &[0])).unwrap();
    let collected = report[0]["collected"].as_u64().unwrap();
    assert!(
        (1..4).contains(&collected),
        "what was there was kept: {report}"
    );
    let there = contents(&dataset(&straight, "4"));
    let here = contents(&dataset(&killed, "4"));
    let names = |files: &[(PathBuf, Vec<u8>)]| -> Vec<PathBuf> {
        files.iter().map(|(name, _)| name.clone()).collect()
    };
    assert_eq!(names(&here), names(&there));
    for ((name, here), (_, there)) in here.iter().zip(&there) {
        assert!(here == there, "{} differs", name.display());
    }
}

/// How a policy of seed 5 flies, trained and flown twice by two workers; one worker says the same.
fn trained(root: &Path, preset: &[&str], sets: &[&str]) -> Value {
    // Enough episodes for the ranges of the contract, or no policy would fly a tick and any would return the same.
    said(&mut collect(root, "20", "2"), &[0]);
    let mut train = command("ted");
    train
        .current_dir(root)
        .arg("train")
        .arg(dataset(root, "20"))
        .args(preset)
        .args(["--seed", "5", "--out", "run"])
        .args(["--workers", "2", "--json"]);
    for set in sets.iter().chain(&["schedule.evaluation_episodes=2"]) {
        train.args(["--set", set]);
    }
    let trained: Value = serde_json::from_str(&said(&mut train, &[0])).unwrap();
    assert_ne!(trained["returns"][0], trained["returns"][1]);

    let mut eval = command("ted");
    eval.current_dir(root)
        .args(["eval", "run", "--episodes", "2", "--workers", "1", "--json"]);
    let code = if trained["faulted"] == 0 { 0 } else { 7 };
    let evaluated: Value = serde_json::from_str(&said(&mut eval, &[code])).unwrap();
    // `ted train` says beside it how sure it is, where a reward can tell.
    for (field, value) in evaluated.as_object().unwrap() {
        assert_eq!(value, &trained[field], "{field}");
    }
    evaluated
}

#[test]
fn a_policy_for_sequences_flies_the_same_whoever_asks_and_however_many_workers_there_are() {
    let folder = tempfile::tempdir().unwrap();
    let sets = [
        "algorithm.steps=60",
        "algorithm.learning_rate=0.01",
        "algorithm.warmup=1",
        "algorithm.segment=10",
        "algorithm.width=8",
        "algorithm.layers=1",
        "algorithm.batch=4",
    ];
    let trained = trained(folder.path(), &["--preset", "oppo"], &sets);
    // It has learned next to nothing and may well leave what the contract allows, but not before it has flown.
    for fault in trained["faults"].as_array().unwrap() {
        assert!(fault["tick"].as_u64().unwrap() > 20, "{fault}");
    }
    assert!(trained["score"].is_number());
}

#[test]
fn the_trainer_s_evaluation_firmware_sim_fly_and_a_cortex_m_agree_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    let sets = ["algorithm.steps=50", "algorithm.hidden=[32]"];
    let evaluated = trained(root, &["--preset", "true"], &sets);
    let fly = |episodes: &str, more: &[&str]| -> Value {
        let mut fly = command("firmware-sim");
        fly.current_dir(root)
            .args(["fly", "run/policy.ted", "--seed", "5", "--json"])
            .args(["--episodes", episodes])
            .args(more);
        serde_json::from_str(&said(&mut fly, &[0])).unwrap()
    };
    let flown = fly("2", &[]);
    assert_eq!(flown["faulted"], 0);
    let returns: Vec<&Value> = (flown["episodes"].as_array().unwrap().iter())
        .map(|e| &e["return"])
        .collect();
    let expected: Vec<&Value> = evaluated["returns"].as_array().unwrap().iter().collect();
    assert_eq!(returns, expected);
    for field in ["return_mean", "return_sd", "faulted", "score", "task"] {
        assert_eq!(flown[field], evaluated[field], "{field}");
    }
    let held: Value =
        serde_json::from_slice(&fs::read(root.join("run/evaluation.json")).unwrap()).unwrap();
    assert_eq!(held, evaluated);

    // Whole episodes on an emulated Cortex-M4F are the host's, in both numbers.
    let in_integers = fly("1", &["--numeric", "integer"]);
    assert_ne!(in_integers["episodes"][0], flown["episodes"][0]);
    let board = ["--on", "mps2-an386"];
    for (numbers, host) in [("f32", &flown), ("integer", &in_integers)] {
        let on_board = fly("1", &[&board[..], &["--numeric", numbers]].concat());
        assert_eq!(on_board["episodes"][0], host["episodes"][0], "{numbers}");
    }
}

#[test]
fn the_default_preset_flies_on_a_cortex_m_in_integers_and_scores_its_episodes_as_the_trainer_does()
{
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    // Few updates everywhere: what is compared is the same for a policy that is worth little.
    let sets = [
        "algorithm.steps=400",
        "algorithm.hidden=[32]",
        "reward.clone.steps=200",
        "reward.network.steps=200",
    ];
    trained(root, &[], &sets);
    let flown = |command_and_more: &[&str]| -> Value {
        let mut flown = command("firmware-sim");
        let (named, more) = command_and_more.split_first().unwrap();
        flown
            .current_dir(root)
            .args([named, "run/policy.ted", "--numeric", "integer", "--json"])
            .args(more);
        serde_json::from_str(&said(&mut flown, &[0])).unwrap()
    };
    let fly = ["fly", "--seed", "5", "--episodes", "1"];
    let board = ["--on", "mps2-an386", "--record", "flight.json"];
    let host = flown(&fly);
    let on_board = flown(&[&fly[..], &board].concat());
    assert_eq!(on_board["episodes"], host["episodes"]);
    // What the board thought of its episode while it flew, and what this machine thinks of the recording.
    let scored = flown(&["score", "--recording", "flight.json"]);
    for field in ["return_hat", "top_k"] {
        let (there, here) = (&on_board["device"]["scores"][0], &scored["episodes"][0]);
        assert!(!here[field].is_null(), "{scored}");
        assert_eq!(there[field], here[field], "{field}");
    }

    // Of the logs, this machine thinks what the trainer does.
    let mut crosscheck = command("ted");
    crosscheck
        .current_dir(root)
        .args(["crosscheck", "run", "--sample", "200", "--episodes", "1"])
        .arg("--json");
    let report: Value = serde_json::from_str(&said(&mut crosscheck, &[0])).unwrap();
    assert_eq!(report["left_out"], Value::Array(Vec::new()));
    let checks = report["checks"].as_array().unwrap();
    for scored in [SCORED_F32, SCORED_INTEGER] {
        let check = checks.iter().find(|check| check["what"] == scored.what);
        let check = check.unwrap_or_else(|| panic!("no {}: {report}", scored.what));
        let counts = [&check["compared"], &check["unequal"]];
        assert_eq!(counts, [20, 0], "{}", scored.what);
    }
}

#[test]
fn a_study_goes_on_from_its_file_of_scores_when_the_runs_are_gone() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    said(&mut collect(root, "20", "2"), &[0]);
    let study = |presets: &str| -> Value {
        let mut study = command("ted");
        study
            .current_dir(root)
            .args(["study", "policies", "--seeds", "0", "--out", "runs"])
            .args(["--scores", "kept/scores.jsonl", "--json"])
            .args(["--presets", presets, "--datasets"])
            .arg(dataset(root, "20"));
        for set in [
            "algorithm.steps=20",
            "algorithm.hidden=[32]",
            "schedule.evaluation_episodes=1",
        ] {
            study.args(["--set", set]);
        }
        serde_json::from_str(&said(&mut study, &[0])).unwrap()
    };
    let lines = || fs::read_to_string(root.join("kept/scores.jsonl")).unwrap();

    let first = study("bc");
    assert_eq!(first[0]["config"]["preset"], "bc");
    assert_eq!(
        first[0]["evaluation"]["returns"].as_array().unwrap().len(),
        1
    );
    let before = lines();
    fs::remove_dir_all(root.join("runs")).unwrap();
    let both = study("bc,zero");
    assert_eq!(both[0], first[0]);
    assert_eq!(both[1]["config"]["preset"], "zero");
    let after = lines();
    assert_eq!(after.strip_prefix(&before).unwrap().lines().count(), 1);
    let made: Vec<_> = contents(&root.join("runs"))
        .into_iter()
        .map(|(name, _)| name)
        .filter(|name| name.ends_with("evaluation.json"))
        .collect();
    assert_eq!(made.len(), 1, "{made:?}");
    assert!(made[0].components().any(|part| part.as_os_str() == "zero"));
}
