//! Pictures of logs of the simulator: answered by in a browser, given to nobody else, and missed without harm where none can be made.

use std::fs;
use std::process::Command;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::browser::{Browser, address};
use super::chromium::Chromium;
use super::page::{NAMELESS, REVIEW, asked};
use super::{about, served};
use crate::command::{Desk, ended, finish, kill, lines, ted};

const LOGS: &str = "ted/drawer-open-v3-paper-n12-s0-v0";

/// A folder with logs of the simulator.
fn logs() -> Desk {
    let desk = Desk::new();
    let mut collect = ted();
    collect
        .env("MINARI_DATASETS_PATH", desk.folder.path())
        .args(["collect", "--task", "drawer-open-v3", "--episodes", "12"]);
    finish(&mut collect).with(0);
    desk
}

fn command(desk: &Desk) -> Command {
    let mut command = about(LOGS, desk, "ask", "mine");
    command.args(["--by", "anna"]);
    command
}

/// Whether both clips are shown in pictures.
const FILMED: &str = "[...document.querySelectorAll('canvas.film')].every(it => !it.hidden)";

/// How far the films of a scene are, once that is said of them.
fn films(page: &Browser, at: &Value, said: impl Fn(&Value) -> bool) -> Value {
    loop {
        let answer = page.get(&format!("/api/film/{at}")).with(200);
        let progress: Value = serde_json::from_str(&answer.body).unwrap();
        if said(&progress) {
            return progress;
        }
    }
}

#[test]
fn somebody_answers_by_pictures_and_looks_at_the_numbers_in_between() {
    let desk = logs();
    let mut child = command(&desk).spawn().unwrap();
    let address = format!("http://{}", address(child.stderr.as_mut().unwrap()));
    let page = Chromium::start([1280, 720]);
    page.open(&address);
    page.until(&asked(1));
    let mut filmed = vec![until_filmed(&page)];
    // A picture has many colours, and another one after a while: the robot moves.
    let colours = "(() => { const it = document.querySelector('canvas.film'); \
        const data = it.getContext('2d').getImageData(0, 0, it.width, it.height).data; \
        return new Set(new Uint32Array(data.buffer)).size; })()";
    page.until(&format!("{colours} > 500"));
    page.key("\u{e012}");
    let seen = "return document.querySelector('canvas.film').toDataURL()";
    page.run("const it = document.getElementById('scrub'); it.value = 0; it.dispatchEvent(new Event('input'))");
    let first = page.run(seen);
    page.run("const it = document.getElementById('scrub'); it.value = it.max; it.dispatchEvent(new Event('input'))");
    assert_ne!(page.run(seen), first);
    page.photograph("pictures");
    assert_eq!(
        page.run("return document.querySelector('.plots').hidden && document.querySelector('.space').hidden"),
        true
    );
    // One key shows the numbers and one the pictures; the place in the clip stays.
    page.key("p");
    assert_eq!(page.run(&format!("return {FILMED}")), false);
    assert_eq!(
        page.run("return !document.querySelector('.plots').hidden && document.getElementById('scrub').value"),
        page.run("return document.getElementById('scrub').max")
    );
    page.photograph("numbers");
    page.click("#film");
    page.until(FILMED);
    assert_eq!(page.run(NAMELESS), 0, "everything has a name");
    // The best and the worst are shown in pictures too, and the question is where it was.
    page.key("w");
    page.until("document.title.startsWith('What the answers did')");
    page.until(FILMED);
    page.photograph("did-pictures");
    page.key("w");
    page.until(&asked(1));
    page.until(FILMED);
    for (number, key) in [(1, "1"), (2, "2"), (3, "3")] {
        page.key(key);
        page.until(&asked(number + 1));
        filmed.push(until_filmed(&page));
    }
    let size = json!({"width": 390, "height": 844, "deviceScaleFactor": 1, "mobile": false});
    page.develop("Emulation.setDeviceMetricsOverride", &size);
    assert_eq!(
        page.run("return document.documentElement.scrollWidth <= innerWidth"),
        true
    );
    page.photograph("pictures-phone");
    page.click("[data-say=right]");
    page.until(REVIEW);
    page.key("\u{e007}");
    page.until("document.title.startsWith('Thank you')");
    ended(child).with(0);
    assert_eq!(lines(&desk.run("mine/preferences.jsonl")), 4);
    assert_eq!(page.complaints(), Vec::<Value>::new());
    assert!(desk.folder.path().join(LOGS).join("pictures").is_dir());
    println!("from each question to its pictures: {filmed:.2?}");
}

/// How long it takes from a question that can be answered to its pictures.
fn until_filmed(page: &Chromium) -> Duration {
    let begun = Instant::now();
    page.until(FILMED);
    begun.elapsed()
}

#[test]
fn pictures_are_for_the_person_and_of_the_open_question_alone() {
    let desk = logs();
    let (child, mut page) = served(command(&desk));
    let scene = page.until("asking");
    let at = &scene["at"];
    let progress = films(&page, at, |it| it["first"][0] == it["first"][1]);
    assert_eq!(
        (&progress["trouble"], &progress["all"][1]),
        (&Value::Null, &json!(200))
    );
    let still = format!("/api/film/{at}/left/99");
    let answer = page.get(&still).with(200);
    assert!(
        answer.head.contains("content-type: image/jpeg"),
        "{}",
        answer.head
    );
    assert!(answer.head.contains("img-src 'self';"), "{}", answer.head);
    for path in [still.as_str(), &format!("/api/film/{at}")] {
        page.stranger().get(path).with(403);
        page.get_as(path, &[("Host", "evil.example")]).with(403);
        page.get_as(path, &[("Origin", "http://evil.example")])
            .with(403);
    }
    for path in [
        format!("/api/film/{at}/left/100"),
        format!("/api/film/{at}/middle/0"),
        format!("/api/film/{at}/left/..%2f..%2f..%2fetc%2fpasswd"),
        format!("/api/film/{at}/../../../etc/passwd"),
        "/api/film/x/left/0".to_owned(),
    ] {
        let status = page.get(&path).status;
        assert!([400, 404].contains(&status), "{path}: {status}");
    }
    page.say(&scene, json!({"say": "left"})).with(204);
    page.until("asking");
    for path in [
        still.as_str(),
        &format!("/api/film/{at}"),
        "/api/film/999999/left/0",
    ] {
        assert_eq!(
            page.get(path).with(204).body,
            "",
            "{path} is over, or never was"
        );
    }
    // They are kept beside the dataset, and made again where the folder is gone.
    let kept = desk.folder.path().join(LOGS).join("pictures");
    while fs::read_dir(&kept).is_err() {
        std::thread::yield_now();
    }
    assert!(kill(child));
    fs::remove_dir_all(&kept).unwrap();
    let (child, mut page) = served(command(&desk));
    let scene = page.until("asking");
    films(&page, &scene["at"], |it| it["all"][0] == it["all"][1]);
    assert!(kill(child));
}

#[test]
fn where_no_picture_can_be_made_the_page_says_why_and_what_to_install_and_asks_by_numbers() {
    let desk = logs();
    // Files in the place of the libraries, which cannot be loaded.
    let broken = desk.folder.path().join("broken");
    fs::create_dir(&broken).unwrap();
    for library in ["EGL", "OSMesa"] {
        for end in ["", ".0", ".1", ".6", ".8"] {
            fs::write(broken.join(format!("lib{library}.so{end}")), "").unwrap();
        }
    }
    let mut ask = command(&desk);
    let mut child = ask.env("LD_LIBRARY_PATH", &broken).spawn().unwrap();
    let address = format!("http://{}", address(child.stderr.as_mut().unwrap()));
    let page = Chromium::start([1280, 720]);
    page.open(&address);
    page.until(&asked(1));
    page.until("document.getElementById('film-note').textContent.startsWith('No pictures')");
    let note = page.run("return document.getElementById('film-note').textContent");
    assert!(
        note.as_str().unwrap().contains("apt install libosmesa6"),
        "{note}"
    );
    assert_eq!(
        page.run("return document.getElementById('film').hidden && !document.querySelector('.plots').hidden"),
        true
    );
    page.key("p");
    page.photograph("no-pictures");
    page.key("1");
    page.until(&asked(2));
    assert_eq!(page.complaints(), Vec::<Value>::new());
    drop(page);
    assert!(kill(child));
    assert_eq!(lines(&desk.run("mine/preferences.jsonl")), 1);

    // Without the simulator nothing is installed for pictures' sake.
    let nowhere = desk.folder.path().join("nowhere");
    let mut ask = command(&desk);
    ask.env("TED_METAWORLD_VENV", &nowhere);
    let (child, mut page) = served(ask);
    let scene = page.until("asking");
    let progress = films(&page, &scene["at"], |_| true);
    let trouble = progress["trouble"].as_str().unwrap();
    assert!(
        trouble.contains("the simulator is not installed"),
        "{trouble}"
    );
    page.say(&scene, json!({"say": "left"})).with(204);
    page.until("asking");
    assert!(kill(child) && !nowhere.exists());
}
