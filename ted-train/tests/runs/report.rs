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
    for foreign in ["<script", "<link", "src=", "href=", "url(", "@import"] {
        assert!(!page.contains(foreign), "{foreign}");
    }
    let addresses = page.match_indices("http").map(|(at, _)| &page[at..at + 26]);
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
