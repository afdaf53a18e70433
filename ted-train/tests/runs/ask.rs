//! `ted ask` as a browser has it: a person who answers over HTTP, changes their mind, comes back after a kill, and others who must
//! not come in.

mod axe;
mod browser;
pub mod chromium;
mod did;
mod film;
mod page;
mod video;

use std::fs;
use std::process::{Child, Command, Stdio};

use serde_json::{Value, json};
use ted_train::preferences::PreferenceLog;

use crate::command::{Desk, ended, finish, kill, lines, ted, terminate};
use browser::Browser;

/// Questions that are quickly chosen.
const QUICK: [&str; 4] = [
    "reward.queries=4",
    "reward.clone.steps=20",
    "reward.clone.hidden=[8]",
    "reward.pool=60",
];

/// A run that is quickly trained, and does not fly.
const SMALL: [&str; 5] = [
    "algorithm.steps=20",
    "algorithm.hidden=[8]",
    "schedule.evaluation_episodes=0",
    "reward.network.steps=20",
    "reward.held_out=20",
];

fn small(mut command: Command) -> Command {
    for set in SMALL {
        command.args(["--set", set]);
    }
    command
}

/// A folder with logs of the toy.
fn toy() -> Desk {
    toy_of(12)
}

fn toy_of(episodes: u32) -> Desk {
    let desk = Desk::new();
    let mut collect = ted();
    collect
        .env("MINARI_DATASETS_PATH", desk.folder.path())
        .args(["collect", "--task", "toy", "--episodes"])
        .arg(episodes.to_string());
    finish(&mut collect).with(0);
    desk
}

fn command(desk: &Desk, verb: &str, out: &str) -> Command {
    let mut command = about("ted/toy-paper-n12-s0-v0", desk, verb, out);
    command.args(["--by", "anna"]);
    command
}

fn about(dataset: &str, desk: &Desk, verb: &str, out: &str) -> Command {
    let mut command = ted();
    command
        .current_dir(desk.folder.path())
        .env("MINARI_DATASETS_PATH", desk.folder.path())
        .args([verb, dataset, "--out", out]);
    for set in QUICK {
        command.args(["--set", set]);
    }
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// A command at work, and the page that it serves.
fn served(mut command: Command) -> (Child, Browser) {
    let mut child = command.spawn().unwrap();
    let browser = Browser::open(child.stderr.as_mut().unwrap());
    (child, browser)
}

#[test]
fn every_answer_is_on_the_disk_before_the_next_question_and_the_end_says_the_next_command() {
    let desk = toy();
    let (child, mut page) = served(small(command(&desk, "ask", "mine")));
    let log = desk.run("mine/preferences.jsonl");
    for number in 1..=4 {
        let scene = page.until("asking");
        assert_eq!(
            (&scene["number"], &scene["of"]),
            (&json!(number), &json!(4))
        );
        assert_eq!(lines(&log), number - 1);
        assert!(
            scene["why"].as_str().unwrap().contains("among the best"),
            "{scene}"
        );
        for side in ["left", "right"] {
            let path = format!("/api/clip/{}/{side}", scene["at"]);
            let clip: Value = serde_json::from_str(&page.get(&path).with(200).body).unwrap();
            assert_eq!(clip["frames"], 100);
            let names: Vec<_> = clip["places"]
                .as_array()
                .unwrap()
                .iter()
                .map(|it| &it["name"])
                .collect();
            assert_eq!(names, ["goal", "point"], "declared, not guessed");
        }
        let word = ["left", "right", "equal", "left"][number - 1];
        page.say(&scene, json!({"say": word})).with(204);
        page.say(&scene, json!({"say": "right"})).with(409);
    }
    let scene = page.until("review");
    assert_eq!(lines(&log), 4);
    let said: Vec<_> = scene["said"]
        .as_array()
        .unwrap()
        .iter()
        .map(|it| &it["said"])
        .collect();
    assert_eq!(said, ["left", "right", "equal", "left"]);
    page.say(&scene, json!({"say": "done"})).with(204);
    let scene = page.until("ended");
    let next = scene["end"]["text"].as_str().unwrap().to_owned();
    let ended = ended(child).with(0);
    assert!(
        ended.said.contains(&format!(
            "4 answers in mine/preferences.jsonl\nnext: {next}"
        )),
        "{}",
        ended.said
    );
    // It is a command that a shell takes as it stands.
    let mut train = Command::new("sh");
    train
        .current_dir(desk.folder.path())
        .env("MINARI_DATASETS_PATH", desk.folder.path())
        .args(["-c", &next.replacen("ted", env!("CARGO_BIN_EXE_ted"), 1)]);
    finish(&mut train).with(0);
    assert!(desk.run("mine/policy.ted").exists());
    assert_eq!(lines(&log), 4);
}

#[test]
fn killed_closed_and_opened_twice_nothing_is_lost_or_asked_twice() {
    let desk = toy();
    let (child, mut page) = served(command(&desk, "ask", "mine"));
    let scene = page.until("asking");
    page.say(&scene, json!({"say": "left"})).with(204);
    let open = page.until("asking");
    assert!(kill(child));
    let log = desk.run("mine/preferences.jsonl");
    let torn = format!(
        "{}{}",
        fs::read_to_string(&log).unwrap(),
        "{\"dataset\":\"te"
    );
    fs::write(&log, torn).unwrap();

    let (child, mut page) = served(command(&desk, "ask", "mine"));
    let mut other = page.tab();
    let scene = page.until("asking");
    assert_eq!(scene["episodes"], open["episodes"], "what was open is open");
    assert_eq!(other.until("asking"), scene);
    page.say(&scene, json!({"say": "right"})).with(204);
    other.say(&scene, json!({"say": "left"})).with(409);
    let third = other.until("asking");
    assert_eq!(third["number"], 3);
    assert_eq!(third["said"][1]["said"], "right");
    // An earlier answer is changed: it is asked again, and the session still ends with four.
    other
        .say(&third, json!({"say": "reopen", "place": 0}))
        .with(204);
    let again = other.until("asking");
    assert_eq!((&again["number"], lines(&log)), (&json!(1), 0));
    other.say(&again, json!({"say": "left"})).with(204);
    let third_again = page.until("asking");
    assert_eq!(
        third_again["number"], 3,
        "the second answer was not asked for again"
    );
    assert_eq!(third_again["episodes"], third["episodes"]);
    terminate(&child);
    ended(child).with(130).telling("every answer is kept");
    assert_eq!(lines(&log), 2);
    let text = fs::read_to_string(&log).unwrap();
    assert!(
        text.lines().all(|line| line.ends_with("\"by\":\"anna\"}")),
        "{text}"
    );
}

#[test]
fn whoever_is_not_the_person_sees_nothing_and_changes_nothing() {
    let desk = toy();
    let (child, mut page) = served(command(&desk, "ask", "mine"));
    let scene = page.until("asking");
    for path in [
        "/",
        "/app.js",
        "/api/scene",
        "/api/clip/1/left",
        "/api/film/1",
        "/?token=00",
    ] {
        page.stranger().get(path).with(403);
    }
    for host in ["evil.example", "127.0.0.1.evil.example", "10.1.1.1"] {
        page.get_as("/api/scene", &[("Host", host)]).with(403);
    }
    page.get_as("/api/scene", &[("Origin", "http://evil.example")])
        .with(403);
    let own = page.origin();
    let left = json!({"at": scene["at"], "say": "left"}).to_string();
    for origin in ["http://evil.example", "null", "http://localhost:1"] {
        page.post_as(&left, &[("Origin", origin)]).with(403);
    }
    page.post_as(&left, &[]).with(403);
    for path in [
        "/../../etc/passwd",
        "/api/clip/../../../../etc/passwd",
        "/api/clip/1/..%2f..%2fetc%2fpasswd",
        "//etc/passwd",
        "/preferences.jsonl",
    ] {
        page.get(path).with(404);
    }
    let long = format!("{{\"at\":1,\"say\":\"{}\"}}", "x".repeat(2000));
    page.post_as(&long, &[("Origin", &own)]).with(413);
    page.announce(1 << 30, &own).with(413);
    for nonsense in [
        "{",
        "{}",
        "{\"at\":1,\"say\":\"reboot\"}",
        "{\"at\":-1,\"say\":\"left\"}",
    ] {
        let answer = page.post_as(nonsense, &[("Origin", &own)]);
        assert!(
            (400..500).contains(&answer.status),
            "{nonsense}: {answer:?}"
        );
    }
    let reopen = json!({"at": scene["at"], "say": "reopen", "place": 99}).to_string();
    page.post_as(&reopen, &[("Origin", &own)]).with(409);
    let head = page.get("/").with(200).head.to_lowercase();
    for header in [
        "content-security-policy: default-src 'none'; script-src 'self'",
        "frame-ancestors 'none'",
        "x-content-type-options: nosniff",
        "referrer-policy: no-referrer",
        "cache-control: no-store",
    ] {
        assert!(head.contains(header), "{header} in {head}");
    }
    assert_eq!(page.until("asking"), scene, "nothing has happened");
    assert!(kill(child));
    assert_eq!(lines(&desk.run("mine/preferences.jsonl")), 0);
}

#[test]
fn the_terminal_asks_the_same_and_leaves_the_same_log_as_the_page() {
    let desk = toy();
    let (child, mut page) = served(command(&desk, "ask", "page"));
    for say in ["left", "cannot-tell", "right", "later", "equal", "right"] {
        let scene = page.until("asking");
        page.say(&scene, json!({"say": say})).with(204);
    }
    let scene = page.until("review");
    page.say(&scene, json!({"say": "done"})).with(204);
    page.until("ended");
    ended(child).with(0);

    let mut command = command(&desk, "ask", "text");
    let mut child = command.arg("--text").stdin(Stdio::piped()).spawn().unwrap();
    let typed = "1\n4\nwhat?\nu 1\n1\n2\n5\n3\n2\n\n";
    std::io::Write::write_all(&mut child.stdin.take().unwrap(), typed.as_bytes()).unwrap();
    let ended = ended(child)
        .with(0)
        .telling("Question 1 of 4")
        .telling("steps 0 to 99")
        .telling("point x")
        .telling("That is none of these");
    assert!(
        ended.told.contains('▁') && ended.told.contains('█'),
        "{}",
        ended.told
    );
    let log = |out: &str| fs::read_to_string(desk.run(out).join("preferences.jsonl")).unwrap();
    assert_eq!(log("page"), log("text"));
    assert_eq!(
        log("page")
            .matches("\"answer\":null,\"later\":true")
            .count(),
        1
    );
}

#[test]
fn a_run_that_asks_first_trains_afterwards_and_is_what_a_replay_of_its_answers_is() {
    let desk = toy();
    let mut train = small(command(&desk, "train", "asked"));
    train.arg("--ask");
    let (child, mut page) = served(train);
    for _ in 0..4 {
        let scene = page.until("asking");
        page.say(&scene, json!({"say": "left"})).with(204);
    }
    let scene = page.until("review");
    page.say(&scene, json!({"say": "done"})).with(204);
    assert_eq!(page.until("ended")["end"]["how"], "goes-on");
    ended(child).with(0);
    let mut replay = ted();
    replay
        .current_dir(desk.folder.path())
        .env("MINARI_DATASETS_PATH", desk.folder.path())
        .args([
            "train",
            "ted/toy-paper-n12-s0-v0",
            "--out",
            "replayed",
            "--preferences",
            "asked/preferences.jsonl",
        ]);
    for set in QUICK.iter().chain(&SMALL) {
        replay.args(["--set", set]);
    }
    finish(&mut replay).with(0);
    crate::command::assert_same_outcome(&desk.run("asked"), &desk.run("replayed"));
    // Trained already: nobody is asked, and nothing is learned anew.
    let mut again = small(command(&desk, "train", "asked"));
    finish(again.arg("--ask"))
        .with(0)
        .telling("the answers are in");
    let dataset = ted_train::dataset::Dataset::open(desk.run("ted/toy-paper-n12-s0-v0")).unwrap();
    let entries = PreferenceLog::read(desk.run("asked/preferences.jsonl"), &dataset).unwrap();
    assert!(entries.iter().all(|entry| entry.said.by == "anna"));
    finish(&mut command(&desk, "ask", "asked")).with(2);
}

#[test]
fn a_run_learns_from_its_own_log_also_where_two_people_were_asked_about_the_same_clips() {
    let desk = toy_of(3);
    let dataset = "ted/toy-paper-n3-s0-v0";
    let asked = |by: &str, typed: &str| {
        let mut ask = small(about(dataset, &desk, "ask", "mine"));
        ask.args(["--by", by, "--text"]).stdin(Stdio::piped());
        let mut child = ask.spawn().unwrap();
        std::io::Write::write_all(&mut child.stdin.take().unwrap(), typed.as_bytes()).unwrap();
        ended(child)
    };
    asked("anna", "1\n1\n1\n").with(130);
    asked("ben", "3\n\n").with(0);
    // There are three pairs and four answers.
    let log = desk.run("mine/preferences.jsonl");
    let before = fs::read(&log).unwrap();
    let mut train = small(about(dataset, &desk, "train", "mine"));
    finish(train.args(["--preferences", "mine/preferences.jsonl"])).with(0);
    assert_eq!(fs::read(&log).unwrap(), before);
}

#[test]
fn what_asks_nobody_and_who_has_no_name_is_refused() {
    let desk = toy();
    let with = |args: &[&str]| {
        let mut command = ted();
        command
            .current_dir(desk.folder.path())
            .env("MINARI_DATASETS_PATH", desk.folder.path())
            .args(["train", "ted/toy-paper-n12-s0-v0"])
            .args(args);
        finish(&mut command)
    };
    with(&["--ask", "--preset", "bc"])
        .with(2)
        .telling("asks nothing");
    with(&["--ask", "--seeds", "0..2"])
        .with(2)
        .telling("one run");
    with(&["--by", "anna"]).with(2).telling("add --ask");
    with(&["--ask", "--by", " "])
        .with(2)
        .telling("--by takes a name");
    with(&["--ask", "--set", "teacher.errs=0.1"])
        .with(2)
        .telling("what --ask asks for are answers");
    with(&["--ask", "--listen", "localhost"])
        .with(2)
        .telling("127.0.0.1:8021");
    assert!(!desk.run("runs").exists(), "nothing was begun");
}
