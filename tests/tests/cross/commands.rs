//! Every command of `ted` as a person uses it, on what one small quickstart wrote.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::binaries::{command, said};

fn ted(at: &Path, arguments: &[&str]) -> Command {
    let mut ted = command("ted");
    ted.current_dir(at).args(arguments);
    ted
}

fn json(command: &mut Command, codes: &[i32]) -> Value {
    serde_json::from_str(&said(command.arg("--json"), codes)).unwrap()
}

/// Where the quickstart says it wrote this.
fn written<'a>(report: &'a Value, what: &str) -> &'a str {
    let all = report["written"].as_array().unwrap();
    let entry = all.iter().find(|entry| entry["what"] == what).unwrap();
    entry["path"].as_str().unwrap()
}

#[test]
fn a_quickstart_goes_all_the_way_and_every_command_works_on_what_it_wrote() {
    let desk = tempfile::tempdir().unwrap();
    let at = desk.path();
    let quickstart = [
        "quickstart",
        "--task",
        "reach-v3",
        "--episodes",
        "20",
        "--steps",
        "40",
        "--out",
        "quick",
    ];
    let report = json(&mut ted(at, &quickstart), &[0]);
    let failed = |report: &Value| {
        let checks = report["checks"].as_array().unwrap();
        assert!(checks.len() >= 5, "{report}");
        checks
            .iter()
            .filter(|check| check["passed"] != true)
            .count()
    };
    assert_eq!(failed(&report["crosscheck"]), 0, "{report}");
    assert!(report["scripted"]["mean_return"].as_f64() > report["dataset"]["mean_return"].as_f64());
    for entry in report["written"].as_array().unwrap() {
        assert!(at.join(entry["path"].as_str().unwrap()).exists(), "{entry}");
    }
    let questions = fs::read_to_string(at.join(written(&report, "questions"))).unwrap();
    assert_eq!(questions.lines().count(), 10, "{questions}");
    // What is done is not done again, and comes out the same.
    assert_eq!(json(&mut ted(at, &quickstart), &[0]), report);

    // Who answers has a run of their own beside it.
    fs::write(at.join("keys"), "1\n".repeat(10) + "\n").unwrap();
    let keys = fs::File::open(at.join("keys")).unwrap();
    let asked = [&quickstart[..], &["--ask", "--text", "--by", "anna"]].concat();
    let asked = json(ted(at, &asked).stdin(keys), &[0]);
    let answers = fs::read_to_string(at.join(written(&asked, "questions"))).unwrap();
    let hers = |line: &str| line.contains("\"by\":\"anna\"") && line.contains("\"answer\":0");
    assert!(
        answers.lines().count() == 10 && answers.lines().all(hers),
        "{answers}"
    );
    assert_eq!(written(&asked, "clone"), written(&report, "clone"));

    let (policy, data) = (written(&report, "artefact"), written(&report, "dataset"));
    let run = Path::new(policy).parent().unwrap().to_str().unwrap();
    for (path, kind) in [(policy, "artefact"), (run, "run"), (data, "dataset")] {
        let inspected = json(&mut ted(at, &["inspect", path]), &[0]);
        assert_eq!(inspected["kind"], kind);
        let text = said(&mut ted(at, &["inspect", path]), &[0]);
        assert!(text.contains("reach-v3"), "{text}");
    }

    said(&mut ted(at, &["export", run, "--out", "again.ted"]), &[0]);
    assert_eq!(
        fs::read(at.join("again.ted")).unwrap(),
        fs::read(at.join(policy)).unwrap()
    );
    // No recorded observation is outside the ranges that were taken from these very logs.
    let replayed = json(&mut ted(at, &["eval", run, "--replay"]), &[0]);
    assert_eq!(
        (&replayed["episodes"], &replayed["ticks"]),
        (&20.into(), &10_000.into())
    );
    assert!(replayed["largest_difference"]["absolute"].as_f64() > Some(0.0));
    // k is 10, and both kinds of numbers find the trainer's 2 episodes of 20.
    let in_integers = ["eval", run, "--replay", "--numeric", "int"];
    for replayed in [replayed, json(&mut ted(at, &in_integers), &[0])] {
        assert_eq!(replayed["in_top_k"], 2, "{replayed}");
    }

    let checked = ["crosscheck", run, "--episodes", "1", "--sample", "200"];
    assert_eq!(failed(&json(&mut ted(at, &checked), &[0])), 0);

    // Another run's artefact in this folder is found out, by what it says and by how it flies.
    let other = [&quickstart[..], &["--seed", "1"]].concat();
    let other = json(&mut ted(at, &other), &[0]);
    fs::copy(at.join(written(&other, "artefact")), at.join(policy)).unwrap();
    let report = json(&mut ted(at, &checked), &[7]);
    let unequal = |what: &str| {
        let checks = report["checks"].as_array().unwrap();
        let named = |check: &&Value| check["what"].as_str().unwrap().starts_with(what);
        let check = checks.iter().find(named);
        check.unwrap_or_else(|| panic!("no {what}: {report}"))["passed"] == false
    };
    for what in ["weights,", "bytes, exported again", "returns, flown again"] {
        assert!(unequal(what), "{what}: {report}");
    }
}

#[test]
fn the_bench_measures_everything_that_it_names() {
    let desk = tempfile::tempdir().unwrap();
    let small = ["bench", "--steps", "2", "--repetitions", "5"];
    let simulator = ["--simulator-steps", "60", "--task", "reach-v3"];
    let text = said(ted(desk.path(), &small).args(simulator), &[0]);
    for named in ["fused", "flex", "ndarray", "act", "bridge"] {
        assert!(text.to_lowercase().contains(named), "no {named}: {text}");
    }
}

#[test]
fn the_doctor_says_what_is_missing_and_what_to_do() {
    let desk = tempfile::tempdir().unwrap();
    let (empty, cache) = (desk.path().join("bin"), desk.path().join("cache"));
    fs::create_dir_all(&empty).unwrap();
    let mut doctor = ted(desk.path(), &["doctor"]);
    doctor.env("PATH", &empty).env("XDG_CACHE_HOME", &cache);
    let report = json(&mut doctor, &[4]);
    let problems: Vec<&str> = report["checks"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|check| check["good"] != true)
        .filter_map(|check| check["found"].as_str())
        .collect();
    for missing in ["python3", "qemu-system-arm"] {
        assert!(
            problems.iter().any(|found| found.contains(missing)),
            "{missing}: {report}"
        );
    }
    assert!(!cache.exists(), "asking changes nothing");
}
