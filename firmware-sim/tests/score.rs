//! `firmware-sim score` as a user meets it: the table, the numbers behind it, and what is said of files that do not fit.

use std::fs;
use std::path::Path;
use std::process::Command;

use firmware_sim::controller::Numeric;
use firmware_sim::plants::recording::Recordings;
use firmware_sim::plants::toy;
use firmware_sim::rollout::episode_seeds;
use firmware_sim::scoring::{judge, score_recording};
use serde_json::Value;
use ted_core::{DiscountClass, NEW_EPISODE, ReturnThreshold, TedDiscount};
use ted_policy::{Artifact, ArtifactBytes, ArtifactSpec, write};

/// Runs a command that must end with `code`; gives its standard output and error.
fn run(folder: &Path, code: i32, args: &[&str]) -> (String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_firmware-sim"))
        .current_dir(folder)
        .args(args)
        .output()
        .unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    let (said, told) = (text(output.stdout), text(output.stderr));
    assert_eq!(output.status.code(), Some(code), "{args:?}: {said}{told}");
    (said, told)
}

const SCORE: [&str; 4] = ["score", "toy.ted", "--recording", "flight.json"];

/// The toy's artefact with a border that parts its flights, and twelve of them.
fn folder_with_flights() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    put(folder.path(), "toy.ted", |spec| {
        let returns = 97;
        let border = ReturnThreshold {
            return_hat: returns as f32,
            last_tied_episode: 0,
        };
        spec.ted = Some(TedDiscount::new(0.99, 0.7, border).unwrap());
        let integers = spec.integers.as_mut().unwrap();
        let border = integers.threshold.as_mut().unwrap();
        border.return_hat = border.return_hat / 60 * returns;
    });
    let fly = ["fly", "toy.ted", "--plant", "toy", "--episodes", "12"];
    let args = [&fly[..], &["--record", "flight.json"]].concat();
    run(folder.path(), 0, &args);
    folder
}

fn put(folder: &Path, name: &str, change: impl Fn(&mut ArtifactSpec<'static>)) {
    let mut spec = toy::artifact_spec().unwrap();
    change(&mut spec);
    fs::write(folder.join(name), write(&spec).unwrap()).unwrap();
}

fn seeds_of(lines: &[&Value]) -> Vec<u64> {
    let seed = |line: &&Value| line["seed"].as_u64().unwrap();
    lines.iter().map(seed).collect()
}

#[test]
fn every_episode_has_a_line_and_the_ones_worth_uploading_are_named() {
    let folder = folder_with_flights();
    let (table, _) = run(folder.path(), 0, &SCORE);
    for part in [
        "12 episodes of flight.json on host, in floats",
        "predicted",
        "top k %",
        "below",
        "0.9900",
        "0.6930",
        "of 12, the best first:",
    ] {
        assert!(table.contains(part), "{part}: {table}");
    }
    for seed in episode_seeds(0, 12) {
        assert!(table.contains(&seed.to_string()), "{seed}: {table}");
    }
}

#[test]
fn the_numbers_are_those_of_the_scorer_that_flies_along() {
    let folder = folder_with_flights();
    let bytes = ArtifactBytes::read(folder.path().join("toy.ted")).unwrap();
    let artifact = Artifact::parse(&bytes).unwrap();
    let recordings = Recordings::read(&folder.path().join("flight.json")).unwrap();
    let reports = [("f32", Numeric::F32), ("integer", Numeric::Integer)].map(|(name, numeric)| {
        let args = [&SCORE[..], &["--json", "--numeric", name]].concat();
        let report: Value = serde_json::from_str(&run(folder.path(), 0, &args).0).unwrap();
        let lines = report["episodes"].as_array().unwrap();
        let mut scorer = judge(&artifact, numeric).unwrap();
        for (line, recording) in lines.iter().zip(&recordings.episodes) {
            let verdict =
                score_recording(&mut scorer, recordings.shape, recording, NEW_EPISODE).unwrap();
            let return_hat = line["return_hat"].as_f64().unwrap() as f32;
            assert_eq!(return_hat.to_bits(), verdict.return_hat.to_bits());
            assert_eq!(line["top_k"], verdict.class == DiscountClass::TopK);
            assert_eq!(line["steps"], recording.rewards.len());
        }
        let mut worth: Vec<&Value> = lines.iter().filter(|line| line["top_k"] == true).collect();
        worth.sort_by_key(|line| -(1e6 * line["return_hat"].as_f64().unwrap()) as i64);
        assert!(!worth.is_empty() && worth.len() < lines.len());
        let upload: Vec<u64> = serde_json::from_value(report["upload"].clone()).unwrap();
        assert_eq!(upload, seeds_of(&worth));
        report
    });
    assert_ne!(reports[0]["episodes"], reports[1]["episodes"]);
}

#[test]
fn a_recording_of_another_robot_is_named_with_what_differs() {
    let folder = folder_with_flights();
    let text = fs::read_to_string(folder.path().join("flight.json")).unwrap();
    let differences = [
        (
            "observation_dim\":5",
            "observation_dim\":4",
            "observation channels is 4, the artefact's 5",
        ),
        (
            "action_dim\":3",
            "action_dim\":2",
            "action channels is 2, the artefact's 3",
        ),
        (
            "control_period_us\":10000",
            "control_period_us\":20000",
            "microseconds is 20000, the artefact's 10000",
        ),
    ];
    for (ours, other, words) in differences {
        assert!(text.contains(ours), "{ours}");
        fs::write(folder.path().join("other.json"), text.replace(ours, other)).unwrap();
        let args = ["score", "toy.ted", "--recording", "other.json"];
        let (said, told) = run(folder.path(), 3, &args);
        assert!(
            said.is_empty() && told.contains("score other.json"),
            "{told}"
        );
        assert!(told.contains(words), "{words}: {told}");
    }
}

#[test]
fn a_recording_that_is_empty_or_cut_is_named() {
    let folder = folder_with_flights();
    let shape =
        r#"{"shape":{"observation_dim":5,"action_dim":3,"control_period_us":10000},"episodes":["#;
    let episode = |observations: &str| {
        format!(
            r#"{shape}{{"seed":1,"observations":[{observations}],"actions":[0,0,0],"rewards":[1],"success":[true]}}]}}"#
        )
    };
    let broken = [
        (format!("{shape}]}}"), "holds no episode"),
        (episode("0"), "observations hold 1 values, 10 are needed"),
        (episode("0,0,1e300,0,0,0,0,0,0,0"), "number out of range"),
        ("{".to_owned(), "EOF"),
    ];
    for (content, words) in broken {
        fs::write(folder.path().join("broken.json"), content).unwrap();
        let args = ["score", "toy.ted", "--recording", "broken.json"];
        let (_, told) = run(folder.path(), 3, &args);
        assert!(
            told.contains("broken.json") && told.contains(words),
            "{words}: {told}"
        );
    }
}

#[test]
fn an_artefact_that_cannot_score_is_named_with_the_way_out() {
    let folder = folder_with_flights();
    put(folder.path(), "no-reward.ted", |spec| {
        spec.reward = None;
        spec.integers = None;
    });
    put(folder.path(), "no-border.ted", |spec| {
        spec.ted = None;
        spec.integers = None;
    });
    put(folder.path(), "no-integers.ted", |spec| {
        spec.integers = None
    });
    let lacking = [
        ("no-reward.ted", "f32", "no reward ensemble; train with"),
        ("no-border.ted", "f32", "no border of TED's; train with"),
        (
            "no-integers.ted",
            "integer",
            "no networks in integers: export it again",
        ),
    ];
    for (artefact, numeric, words) in lacking {
        let args = [
            "score",
            artefact,
            "--recording",
            "flight.json",
            "--numeric",
            numeric,
        ];
        // Nor on a board, which is not even started.
        for on in ["host", "mps2-an386"] {
            let (said, told) = run(folder.path(), 3, &[&args[..], &["--on", on]].concat());
            assert!(said.is_empty() && told.contains(words), "{words}: {told}");
        }
    }
}
