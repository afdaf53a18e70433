//! The `firmware-sim` command as a user meets it: what it prints, and the number it ends with.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn firmware_sim(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_firmware-sim"))
        .current_dir(folder)
        .args(args)
        .output()
        .unwrap()
}

/// Runs a command that must end with `code`; gives its standard output and error.
fn run(folder: &Path, code: i32, args: &[&str]) -> (String, String) {
    let output = firmware_sim(folder, args);
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    let (said, told) = (text(output.stdout), text(output.stderr));
    assert_eq!(output.status.code(), Some(code), "{args:?}: {said}{told}");
    (said, told)
}

fn json(folder: &Path, code: i32, args: &[&str]) -> Value {
    let (said, told) = run(folder, code, args);
    assert_eq!(told, "", "a machine is told nothing on standard error");
    serde_json::from_str(&said).unwrap()
}

fn folder_with_toy() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), 0, &["toy", "toy.ted"]);
    folder
}

#[test]
fn a_flight_is_reported_in_a_table() {
    let folder = folder_with_toy();
    let (said, _) = run(
        folder.path(),
        0,
        &["fly", "toy.ted", "--plant", "toy", "--episodes", "3"],
    );
    for part in [
        "3 episodes of toy-reach on toy",
        "return",
        "+-",
        "score",
        "success     100.0 %",
        "p99",
        "0 of 3 episodes",
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
}

#[test]
fn the_same_seed_gives_the_same_numbers_from_any_number_of_workers() {
    let folder = folder_with_toy();
    let episodes = |workers| {
        let args = [
            "fly",
            "toy.ted",
            "--plant",
            "toy",
            "--episodes",
            "9",
            "--seed",
            "4",
            "--json",
            "--workers",
            workers,
        ];
        json(folder.path(), 0, &args)["episodes"].clone()
    };
    assert_eq!(episodes("1"), episodes("4"));
    let other = [
        "fly",
        "toy.ted",
        "--plant",
        "toy",
        "--episodes",
        "9",
        "--seed",
        "5",
        "--json",
    ];
    assert_ne!(episodes("1"), json(folder.path(), 0, &other)["episodes"]);
}

#[test]
fn a_latched_fault_is_named_and_sets_the_exit_code() {
    let folder = folder_with_toy();
    let fly = [
        "fly",
        "toy.ted",
        "--plant",
        "toy",
        "--episodes",
        "2",
        "--fault",
        "stale@3",
    ];
    let (said, _) = run(folder.path(), 7, &fly);
    assert!(
        said.contains("tick 3: code 4, observation is 1000000 us old"),
        "{said}"
    );
    let report = json(folder.path(), 7, &[&fly[..], &["--json"]].concat());
    assert_eq!(report["faulted"], 2);
    assert_eq!(report["episodes"][1]["fault"]["code"], 4);
}

#[test]
fn a_recorded_flight_is_replayed_without_a_difference() {
    let folder = folder_with_toy();
    let record = [
        "fly",
        "toy.ted",
        "--plant",
        "toy",
        "--episodes",
        "60",
        "--record",
        "flight.json",
        "--json",
    ];
    let flown = json(folder.path(), 0, &record);
    let replay = [
        "fly",
        "toy.ted",
        "--plant",
        "replay",
        "--recording",
        "flight.json",
        "--json",
    ];
    let replayed = json(folder.path(), 0, &replay);
    assert_eq!(replayed["episodes"], flown["episodes"]);
    assert_eq!(
        (&flown["seed"], &replayed["seed"]),
        (&0.into(), &Value::Null)
    );
    assert_eq!(replayed["largest_difference"]["absolute"], 0.0);
}

#[test]
fn a_recording_that_cannot_be_written_is_refused_before_the_flight() {
    let folder = folder_with_toy();
    let fly = ["fly", "toy.ted", "--plant", "toy", "--record"];
    let (said, told) = run(folder.path(), 6, &[&fly[..], &["no/such.json"]].concat());
    assert!(said.is_empty() && told.contains("no/such.json"), "{told}");
}

#[test]
fn a_reader_who_leaves_early_stops_nothing() {
    let folder = folder_with_toy();
    let command = env!("CARGO_BIN_EXE_firmware-sim");
    for pipe in ["| true", "2>&1 >/dev/null | true"] {
        let line = format!(
            "{command} fly toy.ted --plant toy --record f.json {pipe}; exit ${{PIPESTATUS[0]}}"
        );
        let ended = Command::new("bash")
            .current_dir(folder.path())
            .args(["-c", &line])
            .status()
            .unwrap();
        assert_eq!(ended.code(), Some(0), "{pipe}");
        std::fs::remove_file(folder.path().join("f.json")).unwrap();
    }
}

#[test]
fn broken_files_are_named_with_the_code_for_bad_input() {
    let folder = folder_with_toy();
    let toy = fs::read(folder.path().join("toy.ted")).unwrap();
    let mut flipped = toy.clone();
    flipped[toy.len() / 2] ^= 1;
    fs::write(folder.path().join("cut.ted"), &toy[..toy.len() - 1]).unwrap();
    fs::write(folder.path().join("flipped.ted"), flipped).unwrap();
    for artefact in ["missing.ted", "cut.ted", "flipped.ted"] {
        let (_, told) = run(folder.path(), 3, &["fly", artefact, "--plant", "toy"]);
        assert!(told.contains(artefact), "{told}");
    }
    let recordings = [
        (
            "empty.json",
            Some(
                r#"{"shape": {"observation_dim": 5, "action_dim": 3, "control_period_us": 10000}, "episodes": []}"#,
            ),
        ),
        ("missing.json", None),
        ("cut.json", Some("{")),
        (
            "short.json",
            Some(concat!(
                r#"{"shape": {"observation_dim": 5, "action_dim": 3, "control_period_us": 10000}, "episodes": ["#,
                r#"{"seed": 1, "observations": [0], "actions": [], "rewards": [1.0], "success": [true]}]}"#
            )),
        ),
    ];
    for (recording, content) in recordings {
        if let Some(content) = content {
            fs::write(folder.path().join(recording), content).unwrap();
        }
        let (_, told) = run(
            folder.path(),
            3,
            &[
                "fly",
                "toy.ted",
                "--plant",
                "replay",
                "--recording",
                recording,
            ],
        );
        assert!(told.contains(recording), "{told}");
    }
}

#[test]
fn a_command_line_that_makes_no_sense_ends_with_the_code_for_usage() {
    let folder = folder_with_toy();
    let wrong: [&[&str]; 9] = [
        &[],
        &["fly"],
        &["fly", "toy.ted", "--plant", "replay"],
        &["fly", "toy.ted", "--plant", "toy", "--episodes", "0"],
        &["fly", "toy.ted", "--plant", "toy", "--fault", "gremlin@1"],
        &["fly", "toy.ted", "--task", "drawer-opne-v3"],
        &["fly", "toy.ted"],
        &["fly", "toy.ted", "--plant", "toy", "--task", "reach-v3"],
        &["fly", "toy.ted", "--plant", "toy", "--recording", "f.json"],
    ];
    for args in wrong {
        run(folder.path(), 2, args);
    }
    let (_, told) = run(folder.path(), 2, wrong[5]);
    assert!(told.contains("drawer-open-v3"), "{told}");
    let (_, told) = run(folder.path(), 2, wrong[6]);
    assert!(
        told.contains("toy-reach") && told.contains("--plant"),
        "{told}"
    );
}

#[test]
fn help_shows_an_example() {
    let folder = tempfile::tempdir().unwrap();
    for command in ["fly", "score", "toy"] {
        let (said, _) = run(folder.path(), 0, &[command, "--help"]);
        assert!(
            said.contains("Example") && said.contains("firmware-sim fly"),
            "{said}"
        );
    }
}

#[test]
fn more_than_a_machine_could_do_is_refused_before_anything_is_begun() {
    let folder = folder_with_toy();
    let fly = ["fly", "toy.ted", "--plant", "toy"];
    for (flag, range) in [("--episodes", "1..=1000000"), ("--workers", "1..=1024")] {
        for number in ["4000000000", "0", "-1"] {
            let flag_and_number = format!("{flag}={number}");
            let (_, told) = run(folder.path(), 2, &[&fly[..], &[&flag_and_number]].concat());
            assert!(told.contains(&format!("is not in {range}")), "{told}");
        }
    }
    let record = ["--episodes", "1000000", "--record", "flight.json"];
    let (_, told) = run(folder.path(), 2, &[&fly[..], &record].concat());
    assert!(told.contains("at most 10000 episodes"), "{told}");
}
