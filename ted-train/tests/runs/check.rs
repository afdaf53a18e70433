//! `ted check`: said of good logs, of odd ones, and of what is none.

use std::fs;

use serde_json::Value;

use crate::command::{Desk, Ended, finish, ted};
use crate::dataset::{SHAPE, episodes, write};

fn check(desk: &Desk, arguments: &[&str]) -> Ended {
    let mut check = ted();
    check.current_dir(desk.folder.path()).arg("check");
    finish(check.args(arguments))
}

#[test]
fn what_is_odd_comes_first_and_every_glitch_is_named_for_people_and_for_machines() {
    let desk = Desk::new();
    let mut logs = episodes(4, 30);
    logs.iter_mut().for_each(|it| it.rewards.fill(0.0));
    logs[2].observations[11 * SHAPE.observation + 5] = -1e6;
    write(desk.folder.path(), "odd", &logs);
    let said = check(&desk, &["ted/odd-v0"]).with(0).said;
    let lines: Vec<&str> = said.lines().collect();
    assert!(
        lines[0].starts_with("STOPS     no rewards (each is 0)"),
        "{said}"
    );
    assert!(
        lines[1].starts_with("doubtful  1 glitch: the first is -1.000e6 in "),
        "{said}"
    );
    assert!(said.contains("return    - (no rewards)"), "{said}");

    let json = check(&desk, &["ted/odd-v0", "--json"]).with(0).said;
    let json: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["findings"][0]["grade"], "stops");
    let glitch = &json["glitches"][0];
    let place = ["episode", "step", "channel"].map(|name| glitch[name].as_u64().unwrap());
    assert_eq!(place, [2, 11, 5]);
    assert_eq!(glitch["value"], -1e6);
    assert_eq!(json["observations"][5]["glitches"], 1);
    assert!(json["dataset"]["returns"].is_null(), "{json}");
    assert_eq!(json["episodes"]["steps"], serde_json::json!([30, 30, 30]));
}

#[test]
fn a_run_on_logs_with_a_glitch_says_so_and_its_report_too_and_a_controller_is_shown_what_was_recorded()
 {
    let desk = Desk::new();
    let mut logs = episodes(6, 30);
    logs[2].observations[11 * SHAPE.observation + 5] = 1e6;
    let dataset = write(desk.folder.path(), "glitch", &logs);
    finish(&mut desk.train_on(&dataset, "run", "bc", &["algorithm.steps=20"]))
        .with(0)
        .telling("far from all others: 1. What is usual there is learned from instead");
    let page = fs::read_to_string(desk.run("run/report.html")).unwrap();
    assert!(page.contains("What the logs are like"));
    assert!(page.contains("1 glitch: the first is 1.000e6 in "));
    let mut replay = ted();
    replay.current_dir(desk.folder.path());
    replay.args(["eval", "run", "--replay", "--json"]);
    let replayed: Value = serde_json::from_str(&finish(&mut replay).said).unwrap();
    let faults = replayed["faults"].as_array().unwrap();
    assert_eq!(faults.len(), 1, "{replayed}");
}

#[test]
fn what_cannot_be_read_is_named_with_code_3() {
    let desk = Desk::with_dataset();
    check(&desk, &["nowhere"]).with(3).telling("no dataset at ");
    let part = desk.dataset().join("data/1/part-0.arrow");
    let bytes = fs::read(&part).unwrap();
    fs::write(&part, &bytes[..100]).unwrap();
    check(&desk, &["ted/plain-v0"])
        .with(3)
        .telling("episode 1, ")
        .telling("is damaged");
}
