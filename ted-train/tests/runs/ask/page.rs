//! The page in a browser: ten answers by mouse and ten by keyboard, in the light, in the dark, and on a phone.

use serde_json::json;
use std::fs;

use super::browser::address;
use super::chromium::Chromium;
use super::{command, toy};
use crate::command::{ended, kill, lines};

/// Whether the question of this number can be answered.
pub(super) fn asked(number: usize) -> String {
    format!(
        "document.title.startsWith('Question {number} of') && !document.getElementById('asking').hidden \
         && !document.querySelector('[data-say=left]').disabled"
    )
}

/// Whether the page lists all answers.
pub(super) const REVIEW: &str =
    "document.title.startsWith('Every question') && !document.getElementById('done').hidden";

/// How many of the things that can be used or looked at have no name.
pub(super) const NAMELESS: &str = "return [...document.querySelectorAll('button, input, select, canvas')] \
    .filter(it => !it.closest('[hidden]') && it.getAttribute('aria-hidden') !== 'true') \
    .filter(it => !(it.getAttribute('aria-label') || it.textContent.trim() || it.closest('label'))).length";

/// Measures in the page, where no driver is waited for: from what a person does to when the next question can be answered, in
/// milliseconds, in order of length.
const WATCH: &str = "window.waits = []; let begun = 0; const left = document.querySelector('[data-say=left]'); \
    for (const it of ['click', 'keydown']) addEventListener(it, () => { if (!left.disabled) begun = performance.now(); }, true); \
    new MutationObserver(() => { if (begun && !left.disabled) { \
        waits.push(performance.now() - begun); waits.sort((a, b) => a - b); begun = 0; } \
    }).observe(left, { attributeFilter: ['disabled'] });";

#[test]
fn ten_answers_by_mouse_and_ten_by_keyboard_and_the_page_is_quick_and_without_complaint() {
    let desk = toy();
    let mut ask = command(&desk, "ask", "mine");
    let mut child = ask.args(["--answers", "20"]).spawn().unwrap();
    let address = format!("http://{}", address(child.stderr.as_mut().unwrap()));
    let page = Chromium::start([1280, 720]);
    page.open(&address);
    page.until(&asked(1));
    page.photograph("question");
    assert_eq!(
        page.run("return location.pathname + location.search"),
        "/",
        "the token is out of sight"
    );
    assert_eq!(
        page.run("return document.cookie"),
        "",
        "no script can read the cookie"
    );
    assert_eq!(
        page.run("return document.documentElement.scrollWidth <= innerWidth"),
        true
    );
    page.run(WATCH);
    let answer = |act: &dyn Fn(), next: &str| {
        act();
        page.until(next);
    };
    for number in 1..=10 {
        let side = ["left", "right", "equal"][number % 3];
        let press = || page.click(&format!("[data-say={side}]"));
        answer(&press, &asked(number + 1));
    }
    // Another one in between, and one that is taken back.
    answer(&|| page.click("[data-say=undo]"), &asked(10));
    answer(&|| page.key("2"), &asked(11));
    for number in 11..=19 {
        let key = ["1", "2", "3"][number % 3];
        answer(&|| page.key(key), &asked(number + 1));
    }
    // Space plays and pauses, arrows step, signs change the speed, and none of them answers anything.
    page.key("-");
    assert_eq!(
        page.run("return document.getElementById('speed').value"),
        "0.5"
    );
    page.key(" ");
    page.key("\u{e014}");
    page.key("\u{e012}");
    page.until(&asked(20));
    page.photograph("question-20");
    page.develop(
        "Emulation.setEmulatedMedia",
        &json!({"features": [{"name": "prefers-color-scheme", "value": "dark"}]}),
    );
    page.photograph("dark");
    answer(&|| page.key("1"), REVIEW);
    page.photograph("review");
    // Each of the twenty has another question after it but the last, and one was taken back.
    let waits: Vec<f64> = serde_json::from_value(page.run("return waits")).unwrap();
    assert_eq!(waits.len(), 21);
    let (median, slowest) = (waits[10], waits[20]);
    let log = desk.run("mine/preferences.jsonl");
    assert_eq!(lines(&log), 20);
    let text = fs::read_to_string(&log).unwrap();
    let labels: Vec<&str> = text
        .lines()
        .map(|line| {
            line.split_once("\"answer\":")
                .unwrap()
                .1
                .split(',')
                .next()
                .unwrap()
        })
        .collect();
    let wanted: Vec<&str> = (1..=20)
        .map(|number| match number {
            10 => "1",
            20 => "0",
            by_mouse @ 1..=9 => ["0", "1", "0.5"][by_mouse % 3],
            by_key => ["0", "1", "0.5"][by_key % 3],
        })
        .collect();
    assert_eq!(labels, wanted);
    page.key("\u{e007}");
    page.until("document.title.startsWith('Thank you')");
    page.photograph("end");
    let command = page.run("return document.getElementById('command-text').textContent");
    ended(child).with(0);
    assert!(
        command.as_str().unwrap().starts_with("ted train"),
        "{command}"
    );
    assert_eq!(page.complaints(), Vec::<serde_json::Value>::new());
    // Alone on two cores it is a fifth of that; beside other tests it is not.
    assert!(slowest < 5000.0, "{slowest} ms");
    println!("from an answer to the next question: median {median:.0} ms, slowest {slowest:.0} ms");
}

#[test]
fn on_a_phone_and_for_who_wants_no_motion_everything_is_in_reach_and_a_lost_server_is_told() {
    let desk = toy();
    let mut child = command(&desk, "ask", "mine").spawn().unwrap();
    let address = format!("http://{}", address(child.stderr.as_mut().unwrap()));
    let page = Chromium::start([390, 844]);
    page.develop(
        "Emulation.setEmulatedMedia",
        &json!({"features": [{"name": "prefers-reduced-motion", "value": "reduce"}]}),
    );
    page.open(&address);
    page.until(&asked(1));
    page.photograph("phone");
    assert_eq!(
        page.run("return document.documentElement.scrollWidth <= innerWidth"),
        true
    );
    assert_eq!(
        page.run("return document.getElementById('play').textContent.startsWith('Play')"),
        true
    );
    assert_eq!(page.run(NAMELESS), 0, "everything has a name");
    let reach = "return [...document.querySelectorAll('[data-say]')] \
        .every(it => { const box = it.getBoundingClientRect(); return box.bottom <= innerHeight && box.height >= 38; })";
    assert_eq!(page.run(reach), true);
    page.click("[data-say=later]");
    page.until("document.querySelectorAll('#said-list li').length === 1");
    page.until(&asked(1));
    assert!(kill(child));
    page.until("document.getElementById('notice').textContent.includes('does not answer')");
    page.photograph("lost");
    assert_eq!(lines(&desk.run("mine/preferences.jsonl")), 1);
}
