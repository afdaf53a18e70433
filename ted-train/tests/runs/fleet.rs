//! Several runs by one command: side by side, stopped, and with one that fails.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use serde_json::Value;

use crate::command::{
    Desk, Ended, assert_same_outcome, checkpoints, finish, lines, start_until, terminate,
};

/// A fleet of four: two compositions, two seeds.
fn fleet(desk: &Desk, out: &str, sets: &[&str]) -> Command {
    let mut train = desk.train(out, "oprl-i,oprl-i+ted", sets);
    train.args(["--seeds", "0..2"]);
    train
}

/// The folder of a run of a fleet.
fn lane(desk: &Desk, out: &str, preset: &str, seed: u64) -> PathBuf {
    desk.run(out)
        .join("reach-v3")
        .join(preset)
        .join(format!("seed-{seed}"))
}

fn all_lanes(desk: &Desk, out: &str) -> Vec<PathBuf> {
    let seeds = [0, 1];
    let presets = ["oprl-i", "oprl-i+ted"];
    seeds
        .iter()
        .flat_map(|&seed| {
            presets
                .iter()
                .map(move |preset| lane(desk, out, preset, seed))
        })
        .collect()
}

#[test]
fn a_run_has_the_same_bytes_alone_and_in_any_company() {
    let desk = Desk::with_dataset();
    for jobs in ["1", "2", "4"] {
        finish(fleet(&desk, jobs, &[]).args(["--jobs", jobs])).with(0);
    }
    for (preset, seed) in [("oprl-i", "1"), ("oprl-i+ted", "0")] {
        let alone = format!("alone-{preset}");
        finish(desk.train(&alone, preset, &[]).args(["--seed", seed])).with(0);
        for jobs in ["1", "2", "4"] {
            let lane = lane(&desk, jobs, preset, seed.parse().unwrap());
            assert_same_outcome(&lane, &desk.run(&alone));
        }
    }
}

#[test]
fn a_fleet_that_is_stopped_goes_on_to_the_same_bytes() {
    let desk = Desk::with_dataset();
    // No checkpoint falls due: those that are there were made for the stop.
    let sets = ["algorithm.steps=2000", "schedule.checkpoint_every=100000"];
    let mut straight = fleet(&desk, "straight", &sets);
    finish(&mut straight).with(0);
    let mut stopped = fleet(&desk, "stopped", &sets);
    stopped.args(["--jobs", "2"]);
    let first = lane(&desk, "stopped", "oprl-i", 0).join("metrics.jsonl");
    let mut child = start_until(&mut stopped, || lines(&first) > 20);
    terminate(&child);
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let begun = all_lanes(&desk, "stopped").into_iter().filter(|lane| {
        let saved = !checkpoints(lane).is_empty();
        assert!(!lane.join("policy.ted").exists(), "stopped too late");
        saved
    });
    assert!(begun.count() >= 1, "what was learned is kept");
    finish(&mut stopped).with(0);
    let lanes = all_lanes(&desk, "stopped").into_iter();
    for (stopped, straight) in lanes.zip(all_lanes(&desk, "straight")) {
        assert_same_outcome(&stopped, &straight);
    }
}

#[test]
fn a_run_that_fails_is_reported_and_the_others_are_finished() {
    let desk = Desk::with_dataset();
    let broken = lane(&desk, "runs", "oprl-i", 1);
    fs::create_dir_all(&broken).unwrap();
    fs::write(
        broken.join("checkpoints"),
        "a file where a folder has to be",
    )
    .unwrap();
    let Ended { said, .. } = finish(fleet(&desk, "runs", &[]).arg("--json"))
        .with(6)
        .telling("1 of 4 runs were not finished; the first is runs/reach-v3/oprl-i/seed-1");
    let report: Value = serde_json::from_str(&said).unwrap();
    for run in report["runs"].as_array().unwrap() {
        let failed = run["preset"] == "oprl-i" && run["seed"] == 1;
        assert_eq!(run["failure"].is_null(), !failed, "{run}");
        assert_eq!(run["artefact"].is_null(), failed, "{run}");
    }
    let finished = all_lanes(&desk, "runs").into_iter();
    assert_eq!(
        finished
            .filter(|lane| lane.join("policy.ted").exists())
            .count(),
        3
    );
    fs::remove_file(broken.join("checkpoints")).unwrap();
    finish(&mut fleet(&desk, "runs", &[])).with(0);
    assert!(broken.join("policy.ted").exists());
}

#[test]
fn mistakes_are_told_before_anything_is_begun() {
    let desk = Desk::with_dataset();
    let dataset = desk.dataset().display().to_string();
    let cases: [(&[&str], i32, &str); 4] = [
        (&["--seeds", "5..2"], 2, "0..6"),
        (&["--seeds", "0..2", "--seed", "1"], 2, "--seed"),
        (&["--seeds", "0..2", dataset.as_str()], 2, "would share"),
        (
            &["--seeds", "0..2", "--task", "no-such-task-v3"],
            3,
            "no-such-task-v3",
        ),
    ];
    for (arguments, code, part) in cases {
        finish(desk.train("runs", "oprl-i", &[]).args(arguments))
            .with(code)
            .telling(part);
        assert!(!desk.run("runs").exists(), "{arguments:?}");
    }
}

#[test]
#[cfg(not(feature = "cuda"))]
fn a_gpu_that_this_build_cannot_use_is_told_with_the_way_to_one_that_can() {
    let desk = Desk::with_dataset();
    finish(desk.train("run", "true", &[]).args(["--device", "cuda"]))
        .with(1)
        .telling("--features cuda")
        .telling("--device cpu");
    assert!(!desk.run("run").exists(), "nothing was begun");
    finish(desk.train("run", "true", &[]).args(["--device", "cpu"])).with(0);
    let config = fs::read_to_string(desk.run("run").join("config.toml")).unwrap();
    assert!(config.contains("backend = \"fused\""), "{config}");
}
