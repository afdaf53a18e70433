//! What the answers did, and five more of them: over HTTP, in the terminal, and in a browser.

use std::fs;
use std::process::{Child, Command, Stdio};
use std::time::Instant;

use serde_json::{Value, json};

use super::browser::address;
use super::chromium::Chromium;
use super::page::{NAMELESS, REVIEW, asked};
use super::{about, command, served, small, toy, toy_of};
use crate::command::{Desk, Ended, ended, finish, kill, lines, ted};

/// Whether the page shows what the answers did.
const DID: &str =
    "document.title.startsWith('What the answers did') && !document.getElementById('acts').hidden";

/// What the run's folder says how many answers are wanted.
fn wanted(desk: &Desk) -> bool {
    let config = fs::read_to_string(desk.run("mine/config.toml")).unwrap();
    config.contains("queries = 9")
}

/// Runs a command as a shell would.
fn shell(desk: &Desk, line: &str) -> Ended {
    let mut shell = Command::new("sh");
    shell
        .current_dir(desk.folder.path())
        .env("MINARI_DATASETS_PATH", desk.folder.path())
        .args(["-c", &line.replacen("ted", env!("CARGO_BIN_EXE_ted"), 1)]);
    finish(&mut shell)
}

/// Answers that a learned reward rests on.
fn learned_from(desk: &Desk) -> Value {
    let reward = fs::read_to_string(desk.run("mine/reward.json")).unwrap();
    serde_json::from_str::<Value>(&reward).unwrap()["queries"].clone()
}

#[test]
fn whoever_looks_spends_no_question_and_five_more_outlive_a_kill_and_are_trained_on() {
    let desk = toy();
    let log = desk.run("mine/preferences.jsonl");
    let ask = || served(small(command(&desk, "ask", "mine")));
    let (child, mut page) = ask();
    for word in ["left", "right"] {
        let scene = page.until("asking");
        page.say(&scene, json!({"say": word})).with(204);
    }
    let third = page.until("asking");
    let mut other = page.tab();
    assert_eq!(other.until("asking"), third);
    page.say(&third, json!({"say": "look"})).with(204);
    let did = page.until("did");
    assert_eq!(
        (&did["open"], &did["pairs"]),
        (&json!("question"), &json!(5))
    );
    let sure = did["says"][0].as_str().unwrap();
    assert!(sure.starts_with("By 2 answers"), "{sure}");
    for (place, side) in ["left", "right"].into_iter().enumerate() {
        let path = format!("/api/clip/{}/{side}", did["at"]);
        let clip: Value = serde_json::from_str(&page.get(&path).with(200).body).unwrap();
        assert_eq!(clip["episode"], did["shown"][place]["episode"]);
    }
    // In another tab it is the same moment, in which nothing is answered.
    assert_eq!(other.until("did"), did);
    for senseless in [
        json!({"say": "left"}),
        json!({"say": "look"}),
        json!({"say": "done"}),
        json!({"say": "turn", "pair": 5}),
        json!({"say": "reopen", "place": 2}),
    ] {
        page.say(&did, senseless).with(409);
    }
    other.say(&did, json!({"say": "turn", "pair": 4})).with(204);
    page.say(&did, json!({"say": "back"})).with(409);
    let last = page.until("did");
    assert_eq!(last["pair"], 4);
    assert_ne!(last["shown"], did["shown"]);
    page.say(&last, json!({"say": "back"})).with(204);
    let again = other.until("asking");
    assert_eq!(
        (&again["episodes"], &again["number"], &again["said"]),
        (&third["episodes"], &third["number"], &third["said"])
    );
    other.say(&again, json!({"say": "look"})).with(204);
    page.until("did");
    assert!(kill(child) && lines(&log) == 2 && !wanted(&desk));

    let (child, mut page) = ask();
    assert_eq!(page.until("asking")["episodes"], third["episodes"]);
    for word in ["equal", "left"] {
        let scene = page.until("asking");
        page.say(&scene, json!({"say": word})).with(204);
    }
    let review = page.until("review");
    page.say(&review, json!({"say": "more"})).with(409);
    page.say(&review, json!({"say": "look"})).with(204);
    let did = page.until("did");
    assert_eq!(did["open"], "review");
    page.say(&did, json!({"say": "more"})).with(204);
    let fifth = page.until("asking");
    assert_eq!((&fifth["number"], &fifth["of"]), (&json!(5), &json!(9)));
    assert!(wanted(&desk), "that is on the disk before the question");
    page.say(&fifth, json!({"say": "right"})).with(204);
    let sixth = page.until("asking");
    assert!(kill(child));

    let (child, mut page) = ask();
    let scene = page.until("asking");
    assert_eq!((&scene["number"], &scene["of"]), (&json!(6), &json!(9)));
    assert_eq!(scene["episodes"], sixth["episodes"]);
    page.say(&scene, json!({"say": "look"})).with(204);
    let did = page.until("did");
    assert_eq!(did["open"], "extra");
    page.say(&did, json!({"say": "back"})).with(204);
    for _ in 6..=9 {
        let scene = page.until("asking");
        page.say(&scene, json!({"say": "left"})).with(204);
    }
    let review = page.until("review");
    page.say(&review, json!({"say": "done"})).with(204);
    let next = page.until("ended")["end"]["text"]
        .as_str()
        .unwrap()
        .to_owned();
    ended(child).with(0);
    assert!(next.contains("--set reward.queries=9 "), "{next}");
    assert!(!next.contains("reward.queries=4"), "{next}");
    shell(&desk, &next).with(0);
    assert_eq!((lines(&log), learned_from(&desk)), (9, json!(9)));
}

#[test]
fn answers_to_the_same_two_that_differ_are_named_and_can_be_asked_again() {
    let desk = toy_of(3);
    let (child, mut page) = served(about("ted/toy-paper-n3-s0-v0", &desk, "ask", "mine"));
    for _ in 1..=3 {
        let scene = page.until("asking");
        page.say(&scene, json!({"say": "left"})).with(204);
    }
    // There are three pairs: one of them comes again, on the same sides or not.
    let fourth = page.until("asking");
    let before = fourth["said"].as_array().unwrap();
    let same = before.iter().any(|it| it["episodes"] == fourth["episodes"]);
    let other = if same { "right" } else { "left" };
    page.say(&fourth, json!({"say": other})).with(204);
    let review = page.until("review");
    page.say(&review, json!({"say": "look"})).with(204);
    let did = page.until("did");
    let odd = did["odd"].as_array().unwrap();
    let differ: Vec<&Value> = odd
        .iter()
        .filter(|it| it["says"].as_str().unwrap().contains("about the same two"))
        .map(|it| &it["place"])
        .collect();
    assert_eq!(differ.len(), 2, "{odd:?}");
    assert_eq!(differ[1], 3);
    page.say(&did, json!({"say": "reopen", "place": 3}))
        .with(204);
    let again = page.until("asking");
    assert_eq!(
        (&again["number"], &again["episodes"]),
        (&fourth["number"], &fourth["episodes"])
    );
    let same_as_before = if same { "left" } else { "right" };
    page.say(&again, json!({"say": same_as_before})).with(204);
    let review = page.until("review");
    page.say(&review, json!({"say": "look"})).with(204);
    let odd = page.until("did")["odd"].to_string();
    assert!(!odd.contains("about the same two"), "{odd}");
    assert!(kill(child));
}

/// A command whose terminal is typed to.
fn typed(mut command: Command, text: &str) -> Ended {
    let mut child: Child = command.arg("--text").stdin(Stdio::piped()).spawn().unwrap();
    std::io::Write::write_all(&mut child.stdin.take().unwrap(), text.as_bytes()).unwrap();
    ended(child)
}

#[test]
fn in_the_terminal_a_letter_tells_the_same_and_more_may_become_enough() {
    let desk = toy();
    let text = "1\nw\n2\n3\ne\n1\nw\nm\n1\n1\ne\n\n";
    let ended = typed(small(command(&desk, "ask", "mine")), text)
        .with(0)
        .telling("What the answers did\nBy 1 answers")
        .telling("What the answers did\nBy 4 answers")
        .telling("Best, in deviations from the average of the logs: episodes ")
        .telling("That is none of these")
        .telling("Question 7 of 9")
        .telling("[e] these are my answers");
    assert!(ended.said.contains("6 answers in"), "{}", ended.said);
    let (_, next) = ended.said.split_once("next: ").unwrap();
    shell(&desk, next).with(0);
    assert_eq!(learned_from(&desk), 6);
}

#[test]
fn a_run_that_asks_first_trains_on_all_that_were_given_also_by_the_same_command_again() {
    let desk = toy();
    let train = || {
        let mut train = small(command(&desk, "train", "mine"));
        train.arg("--ask");
        train
    };
    let text = "1\n2\n1\n2\nm\n1\n1\n1\n1\n1\n\n";
    typed(train(), text).with(0).telling("Question 9 of 9");
    assert_eq!(learned_from(&desk), 9);
    finish(&mut train()).with(0).telling("the answers are in");
}

#[test]
fn a_preset_that_learns_later_says_so() {
    let desk = toy();
    let mut train = ted();
    train
        .current_dir(desk.folder.path())
        .env("MINARI_DATASETS_PATH", desk.folder.path())
        .args(["train", "ted/toy-paper-n12-s0-v0", "--out", "mine", "--ask"])
        .args(["--preset", "oprl-i"])
        .stderr(Stdio::piped());
    typed(train, "w\nq\n")
        .with(130)
        .telling("This preset has a ranking of the episodes only after all answers are in");
}

/// Opens the page that a command serves.
fn opened(desk: &Desk, page: &Chromium) -> Child {
    let mut ask = small(command(desk, "ask", "mine"));
    let mut child = ask.args(["--answers", "10"]).spawn().unwrap();
    page.open(&format!(
        "http://{}",
        address(child.stderr.as_mut().unwrap())
    ));
    child
}

#[test]
fn in_a_browser_somebody_looks_turns_pages_and_answers_five_more_across_a_kill() {
    let desk = toy();
    let log = desk.run("mine/preferences.jsonl");
    let page = Chromium::start([1280, 720]);
    let child = opened(&desk, &page);
    for number in 1..=3 {
        page.until(&asked(number));
        page.key(["1", "2", "3"][number % 3]);
    }
    page.until(&asked(4));
    let shown =
        "return [...document.querySelectorAll('.clip-name')].map(it => it.textContent).join()";
    let question = page.run(shown);
    let begun = Instant::now();
    page.key("w");
    page.until(DID);
    println!(
        "from the key to what the answers did: {:.2?}",
        begun.elapsed()
    );
    page.photograph("did");
    let best = page.run(shown);
    assert!(
        best.as_str().unwrap().contains("deviations from average"),
        "{best}"
    );
    // A digit answers nothing here, and turning the page leaves the focus where it is.
    page.key("1");
    page.click("#pair-next");
    page.until("document.getElementById('did-pair').textContent.startsWith('Pair 2 of 5')");
    assert_eq!(page.run("return document.activeElement.id"), "pair-next");
    assert_ne!(page.run(shown), best);
    page.key("b");
    page.until("document.getElementById('did-pair').textContent.startsWith('Pair 1 of 5')");
    assert_eq!(page.run(shown), best);
    assert_eq!(page.run(NAMELESS), 0, "everything has a name");
    assert_eq!(lines(&log), 3);
    page.click("#leave");
    page.until(&asked(4));
    assert_eq!(page.run(shown), question);
    for number in 4..=9 {
        page.key(["1", "2", "3"][number % 3]);
        page.until(&asked(number + 1));
    }
    page.key("2");
    page.until(REVIEW);
    page.click("#look-back");
    page.until(DID);
    page.photograph("did-review");
    dark(&page, "dark");
    page.photograph("did-dark");
    dark(&page, "light");
    resize(&page, [390, 844]);
    assert_eq!(
        page.run("return document.documentElement.scrollWidth <= innerWidth"),
        true
    );
    let reach = "return [...document.querySelectorAll('#acts button')].filter(it => !it.hidden) \
        .every(it => { const box = it.getBoundingClientRect(); return box.bottom <= innerHeight && box.height >= 38; })";
    assert_eq!(page.run(reach), true);
    page.photograph("did-phone");
    page.run("scrollTo(0, document.body.scrollHeight)");
    page.photograph("did-phone-foot");
    resize(&page, [1280, 720]);
    page.click("#more");
    page.until(&asked(11));
    assert_eq!(page.run("return document.title.includes('of 15')"), true);
    for number in 11..=12 {
        page.key("1");
        page.until(&asked(number + 1));
    }
    assert_eq!(page.complaints(), Vec::<Value>::new());
    assert!(kill(child));

    let child = opened(&desk, &page);
    page.until(&asked(13));
    // Of the server that was lost.
    page.complaints();
    page.key("w");
    page.until(DID);
    page.photograph("did-extra");
    assert_eq!(
        page.run("return !document.getElementById('enough').hidden && !document.getElementById('more').hidden"),
        true
    );
    page.click("#leave");
    for number in 13..=15 {
        page.until(&asked(number));
        page.key("2");
    }
    page.until(REVIEW);
    page.key("w");
    page.until(DID);
    page.click("#enough");
    page.until("document.title.startsWith('Thank you')");
    let next = page.run("return document.getElementById('command-text').textContent");
    ended(child).with(0);
    assert_eq!(lines(&log), 15);
    let next = next.as_str().unwrap();
    assert!(next.contains("--set reward.queries=15 "), "{next}");
    assert_eq!(page.complaints(), Vec::<Value>::new());
    shell(&desk, next).with(0);
    assert_eq!((lines(&log), learned_from(&desk)), (15, json!(15)));
}

fn dark(page: &Chromium, scheme: &str) {
    let feature = json!({"name": "prefers-color-scheme", "value": scheme});
    page.develop(
        "Emulation.setEmulatedMedia",
        &json!({"features": [feature]}),
    );
}

fn resize(page: &Chromium, [width, height]: [u32; 2]) {
    let size = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": false});
    page.develop("Emulation.setDeviceMetricsOverride", &size);
}
