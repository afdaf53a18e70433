//! `ted report`: what became of a run, on one page.

use std::fs;

use serde_json::{Value, json};

use crate::ask::chromium::Chromium;
use crate::command::{Desk, Ended, finish, ted};

fn report(desk: &Desk, args: &[&str]) -> Ended {
    finish(
        ted()
            .current_dir(desk.folder.path())
            .arg("report")
            .args(args),
    )
}

fn page(desk: &Desk, name: &str) -> String {
    fs::read_to_string(desk.run(name)).unwrap()
}

/// Nothing is fetched from anywhere, and nothing runs.
fn assert_self_contained(page: &str) {
    for foreign in ["<script", "<link", "src=", "url(", "@import"] {
        assert!(!page.contains(foreign), "{foreign}");
    }
    let inside = page.matches("href=\"data:image/jpeg;base64,").count();
    assert_eq!(page.matches("href=").count(), inside);
    let text = page.split("base64,").map(|part| match part.find('"') {
        // What letters a picture's bytes happen to make is nobody's address.
        Some(end) if part.starts_with("/9j/") => &part[end..],
        _ => part,
    });
    let text: String = text.collect();
    let addresses = text.match_indices("http").map(|(at, _)| &text[at..at + 26]);
    addresses.for_each(|address| assert_eq!(address, "http://www.w3.org/2000/svg"));
}

#[test]
fn a_report_tells_all_of_a_run_and_needs_nothing_else() {
    let desk = Desk::with_dataset();
    finish(&mut desk.train("run", "oprl-i+ted", &[])).with(0);
    let said = report(&desk, &["run"]).with(0).said;
    assert!(said.starts_with("Nobody has flown this policy"), "{said}");
    assert!(said.ends_with("wrote run/report.html\n"), "{said}");
    let page = page(&desk, "run/report.html");
    assert_self_contained(&page);
    assert_eq!(page.matches("class=\"question\"").count(), 10);
    for part in [
        "Nobody has flown this policy",
        "What was asked and answered",
        "The best by prediction",
        "Predicted against true returns",
        "The best 70 % of",
        "How it learned",
        "What the integers cost",
        "Where it comes from",
    ] {
        assert!(page.contains(part), "{part}");
    }
    // Made again, it is the same.
    let json = report(&desk, &["run", "--out", "again.html", "--json"])
        .with(0)
        .said;
    let json: Value = serde_json::from_str(&json).unwrap();
    assert!(
        json["verdict"]["logs"].is_null() && json["report"] == "again.html",
        "{json}"
    );
    assert_eq!(page, self::page(&desk, "again.html"));
    let browser = Chromium::start([1280, 720]);
    browser.open(&format!("file://{}", desk.run("run/report.html").display()));
    browser.photograph("report");
    let dark = json!({"features": [{"name": "prefers-color-scheme", "value": "dark"}]});
    browser.develop("Emulation.setEmulatedMedia", &dark);
    browser.photograph("report-dark");
    let phone = json!({"width": 390, "height": 844, "deviceScaleFactor": 1, "mobile": true});
    browser.develop("Emulation.setDeviceMetricsOverride", &phone);
    browser.photograph("report-phone");
    let fits = "return document.documentElement.scrollWidth <= innerWidth";
    assert_eq!(browser.run(fits), true);
    assert_eq!(browser.complaints(), Vec::<Value>::new());
}

#[test]
fn a_run_that_asked_nobody_has_a_report_without_questions() {
    let desk = Desk::with_dataset();
    finish(&mut desk.train("run", "bc", &[])).with(0);
    report(&desk, &["run"]).with(0);
    let page = page(&desk, "run/report.html");
    assert_self_contained(&page);
    assert!(!page.contains("What was asked") && !page.contains("by prediction"));
    assert!(page.contains("How it learned"));
}

#[test]
fn what_is_no_run_has_no_report() {
    let desk = Desk::with_dataset();
    report(&desk, &["nowhere"]).with(3).telling("nowhere");
    // Nothing is left where the page cannot be written.
    finish(&mut desk.train("run", "bc", &[])).with(0);
    report(&desk, &["run", "--out", "missing/report.html"])
        .with(6)
        .telling("missing");
}

/// A small run of `steer` on a few episodes of a task that were collected for it, flown three times.
fn flown(task: &str) -> Desk {
    let desk = Desk::new();
    let mut collect = ted();
    collect.env("MINARI_DATASETS_PATH", desk.folder.path());
    let args = ["collect", "--task", task, "--episodes", "12"];
    finish(collect.args(args)).with(0);
    let dataset = desk.run(&format!("ted/{task}-paper-n12-s0-v0"));
    let mut train = ted();
    train.current_dir(desk.folder.path()).arg("train");
    train.arg(dataset).args(["--out", "run"]);
    for set in QUICK {
        train.args(["--set", set]);
    }
    finish(&mut train).with(0);
    desk
}

const QUICK: [&str; 9] = [
    "reward.queries=21",
    "reward.clone.steps=20",
    "reward.clone.hidden=[8]",
    "reward.network.steps=20",
    "reward.pool=60",
    "reward.held_out=20",
    "algorithm.steps=20",
    "algorithm.hidden=[8]",
    "schedule.evaluation_episodes=3",
];

/// What the caption of the flight says that is nearest the mean of those in evaluation.json.
fn caption(desk: &Desk) -> String {
    let text = fs::read_to_string(desk.run("run/evaluation.json")).unwrap();
    let flown: Value = serde_json::from_str(&text).unwrap();
    let mean = flown["return_mean"].as_f64().unwrap();
    let returns = flown["returns"].as_array().unwrap();
    let returns: Vec<f64> = returns.iter().map(|it| it.as_f64().unwrap()).collect();
    let off = |place: &usize| (returns[*place] - mean).abs();
    let nearest = (0..3).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap();
    format!(
        "flight {} of 3, return {:.0}, ",
        nearest + 1,
        returns[nearest]
    )
}

#[test]
fn logs_of_the_simulator_are_shown_in_pictures_and_so_is_a_flight() {
    let desk = flown("drawer-open-v3");
    let page = page(&desk, "run/report.html");
    assert_self_contained(&page);
    assert!(page.contains(&caption(&desk)), "{}", caption(&desk));
    // Twenty questions of two clips, three best, three worst and a flight, each of fourteen stills.
    assert_eq!(page.matches("class=\"film\"").count(), 47);
    assert_eq!(page.matches("data:image/jpeg;base64,").count(), 47 * 14);
    assert_eq!(page.matches("class=\"question\"").count(), 21);
    let browser = Chromium::start([1280, 720]);
    browser.open(&format!("file://{}", desk.run("run/report.html").display()));
    browser.photograph("report-pictures");
    assert_eq!(browser.complaints(), Vec::<Value>::new());
    // Made again, the stills come from beside the dataset; and without a simulator there is a report too.
    let mut again = ted();
    again
        .current_dir(desk.folder.path())
        .arg("report")
        .arg("run");
    finish(&mut again).with(0);
    assert_eq!(page, self::page(&desk, "run/report.html"));
    again.env("TED_METAWORLD_VENV", desk.run("nothing"));
    finish(&mut again).with(0);
    let plain = self::page(&desk, "run/report.html");
    assert!(!plain.contains("image/jpeg") && !plain.contains("A flight like most"));
}

#[test]
fn a_flight_on_the_toy_is_shown_by_its_places() {
    let desk = flown("toy");
    let page = page(&desk, "run/report.html");
    assert_self_contained(&page);
    assert!(page.contains(&caption(&desk)), "{}", caption(&desk));
    assert!(page.contains("A flight like most") && !page.contains("image/jpeg"));
}
