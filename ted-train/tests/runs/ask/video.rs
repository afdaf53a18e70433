//! Videos that belong to the logs: shown beside each other in step, cut to their clips, in ranges of bytes, and missed without harm.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::{Value, json};

use super::browser::address;
use super::chromium::Chromium;
use super::page::{NAMELESS, asked};
use super::served;
use crate::command::{Desk, finish, kill, lines, ted};
use crate::venv;

const SOURCES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/sources");
const TOP: &str = "logs/videos/observation.images.top/chunk-000";

/// A folder with a dataset of LeRobot's logs, and which picture of its file is the first one of each episode.
fn logs() -> (Desk, Vec<u64>) {
    let desk = Desk::new();
    let sources = Path::new(SOURCES);
    let python = venv::python("sources", &sources.join("requirements.lock"));
    let made = Command::new(python)
        .arg("-B")
        .arg(sources.join("filmed.py"))
        .arg(desk.run("logs"))
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&made.stderr);
    assert!(made.status.success(), "{said}");
    let made: Value = serde_json::from_slice(&made.stdout).unwrap();
    let mut import = ted();
    import
        .current_dir(desk.folder.path())
        .env("MINARI_DATASETS_PATH", desk.folder.path())
        .env(
            "TED_READER_VENV",
            Path::new(env!("CARGO_TARGET_TMPDIR")).join("reader"),
        )
        .args(["import", "logs", "--as", "mine/so101-v0"]);
    let imported = finish(&mut import).with(0);
    let cameras = "videos    of observation.images.top, observation.images.wrist";
    assert!(imported.said.contains(cameras), "{}", imported.said);
    (desk, serde_json::from_value(made["first"].clone()).unwrap())
}

/// Asks about clips of eighteen steps.
fn command(desk: &Desk) -> Command {
    let mut command = ted();
    command
        .current_dir(desk.folder.path())
        .env("MINARI_DATASETS_PATH", desk.folder.path())
        .args(["train", "mine/so101-v0", "--ask", "--by", "anna"])
        .args(["--preset", "oprl-i", "--out", "mine"]);
    for set in [
        "reward.segment=18",
        "reward.pool=50",
        "reward.hidden=[16]",
        "reward.epochs=20",
    ] {
        command.args(["--set", set]);
    }
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// Whether both clips are shown in videos.
const FILMED: &str = "[...document.querySelectorAll('video')].every(it => !it.hidden && it.getBoundingClientRect().height > 0)";

/// `at(side)` is the number in the picture that a video shows, and `reddish(side)` whether it is the second camera's.
const NUMBERS: &str = "window.drawn = (side) => { const it = document.querySelectorAll('video')[side]; \
        const canvas = Object.assign(document.createElement('canvas'), { width: 320, height: 192 }); \
        const context = canvas.getContext('2d', { willReadFrequently: true }); context.drawImage(it, 0, 0, 320, 192); return context; }; \
    window.at = (side) => { const context = drawn(side); let number = 0; for (let bit = 0; bit < 10; bit += 1) \
        number = 2 * number + (context.getImageData(32 * bit + 16, 48, 1, 1).data[0] > 127); return number; }; \
    window.reddish = (side) => { const [red, , blue] = drawn(side).getImageData(4, 185, 1, 1).data; return red > blue; };";

/// Moves both clips to a frame.
fn scrub(page: &Chromium, frame: u64) {
    page.run(&format!(
        "const it = document.getElementById('scrub'); it.value = {frame}; it.dispatchEvent(new Event('input'))"
    ));
}

/// The picture of its file with which each clip begins.
fn begin(page: &Chromium, first: &[u64]) -> [u64; 2] {
    let captions =
        page.run("return [...document.querySelectorAll('.clip-name')].map(it => it.textContent)");
    let captions: [String; 2] = serde_json::from_value(captions).unwrap();
    captions.map(|caption| {
        // Such as "episode 3, steps 12 to 21".
        let numbers: Vec<u64> = caption
            .split([' ', ','])
            .filter_map(|it| it.parse().ok())
            .collect();
        assert_eq!(numbers[2] - numbers[1], 17, "{caption}");
        first[numbers[0] as usize] + numbers[1]
    })
}

/// Waits until both videos show these pictures of their files.
fn until_at(page: &Chromium, [left, right]: [u64; 2]) {
    page.until(&format!("at(0) === {left} && at(1) === {right}"));
}

#[test]
fn both_clips_are_shown_in_videos_in_step_and_cut_to_what_is_asked_about() {
    let (desk, first) = logs();
    let mut child = command(&desk).spawn().unwrap();
    let address = format!("http://{}", address(child.stderr.as_mut().unwrap()));
    let page = Chromium::start([1280, 720]);
    page.open(&address);
    page.until(&asked(1));
    page.until(FILMED);
    page.run(NUMBERS);
    let clips = begin(&page, &first);
    // Nothing of what stands before or after a clip in its file is shown, however often it runs.
    page.run(
        "window.shown = [[], []]; document.querySelectorAll('video').forEach((it, side) => { \
         const look = (now, { mediaTime }) => { shown[side].push(mediaTime); it.requestVideoFrameCallback(look); }; \
         it.requestVideoFrameCallback(look); })",
    );
    page.until("shown.every(it => it.length > 20) && document.getElementById('seen').textContent.startsWith('100')");
    // Half as fast, less of it is shown picture by picture.
    page.key("-");
    page.until("shown.every(it => it.length > 60)");
    let shown: [Vec<f64>; 2] = serde_json::from_value(page.run("return shown")).unwrap();
    for (begin, times) in clips.into_iter().zip(&shown) {
        let inside = (begin as f64 - 0.5) / 30.0..(begin as f64 + 17.5) / 30.0;
        assert!(
            times.iter().all(|time| inside.contains(time)),
            "{inside:?}: {times:?}"
        );
    }
    // Each frame of the clip is its own picture.
    for frame in [0, 17, 4] {
        scrub(&page, frame);
        until_at(&page, clips.map(|begin| begin + frame));
    }
    page.photograph("videos");
    page.key("\u{e014}");
    until_at(&page, clips.map(|begin| begin + 5));
    assert_eq!(page.run("return reddish(0) || reddish(1)"), false);
    // Another camera shows the same moment, and is the one of the next questions.
    page.run("const it = document.getElementById('camera'); it.value = 1; it.dispatchEvent(new Event('change'))");
    page.until(FILMED);
    until_at(&page, clips.map(|begin| begin + 5));
    assert_eq!(page.run("return reddish(0) && reddish(1)"), true);
    // One key shows the numbers and one the videos; the place in the clip stays.
    page.key("p");
    let numbers =
        "!document.querySelector('.plots').hidden && document.querySelector('video').hidden";
    page.until(numbers);
    page.key("p");
    page.until(FILMED);
    until_at(&page, clips.map(|begin| begin + 5));
    assert_eq!(page.run(NAMELESS), 0, "everything has a name");
    page.key("1");
    page.until(&asked(2));
    page.until(FILMED);
    let clips = begin(&page, &first);
    scrub(&page, 17);
    until_at(&page, clips.map(|begin| begin + 17));
    assert_eq!(page.run("return reddish(0) && reddish(1)"), true);
    assert_eq!(page.complaints(), Vec::<Value>::new());

    // What cannot be played is said in a line, and the question is asked by the numbers.
    for file in ["file-000.mp4", "file-001.mp4"] {
        fs::write(desk.run(TOP).join(file), "no video").unwrap();
    }
    page.run("const it = document.getElementById('camera'); it.value = 0; it.dispatchEvent(new Event('change'))");
    let says = |words: &str| {
        format!("document.getElementById('film-note').textContent.includes('{words}')")
    };
    page.until(&says(
        "this browser cannot play the video of observation.images.top",
    ));
    page.until(numbers);
    fs::rename(desk.run("logs"), desk.run("elsewhere")).unwrap();
    page.key("2");
    page.until(&asked(3));
    page.until(&says("file-00"));
    page.until(&says(
        "is gone; put it back, or import the logs again from where they are now",
    ));
    page.until(numbers);
    page.photograph("videos-gone");
    page.key("1");
    page.until(&asked(4));
    assert_eq!(lines(&desk.run("mine/preferences.jsonl")), 3);
    drop(page);
    assert!(kill(child));
}

#[test]
fn a_video_is_sent_in_ranges_to_the_person_and_of_the_open_question_alone() {
    let (desk, _) = logs();
    let (child, mut page) = served(command(&desk));
    let scene = page.until("asking");
    let at = &scene["at"];
    let progress = page.get(&format!("/api/film/{at}")).with(200);
    let progress: Value = serde_json::from_str(&progress.body).unwrap();
    let cameras = json!(["observation.images.top", "observation.images.wrist"]);
    assert_eq!(
        (&progress["trouble"], &progress["videos"]["cameras"]),
        (&Value::Null, &cameras)
    );
    let path = format!("/api/video/{at}/left/0");
    let whole = page.get(&path).with(200);
    let length = fs::read(desk.run(TOP).join("file-000.mp4")).unwrap().len();
    let other = fs::read(desk.run(TOP).join("file-001.mp4")).unwrap().len();
    let has = |head: &str, line: &str| head.lines().any(|it| it == line);
    for line in ["content-type: video/mp4", "accept-ranges: bytes"] {
        assert!(has(&whole.head, line), "{}", whole.head);
    }
    assert!(whole.head.contains("media-src 'self';"), "{}", whole.head);
    let sent = |head: &str| {
        let length = head
            .lines()
            .find_map(|it| it.strip_prefix("content-length: "));
        length.unwrap().parse::<usize>().unwrap()
    };
    let all = sent(&whole.head);
    assert!([length, other].contains(&all), "{all}");
    for (range, status, place, count) in [
        ("bytes=0-", 206, format!("bytes 0-{}/{all}", all - 1), all),
        ("bytes=4-7", 206, format!("bytes 4-7/{all}"), 4),
        (
            "bytes=-5",
            206,
            format!("bytes {}-{}/{all}", all - 5, all - 1),
            5,
        ),
        ("bytes=999999999-", 416, format!("bytes */{all}"), 0),
    ] {
        let part = page.get_as(&path, &[("Range", range)]).with(status);
        assert!(
            has(&part.head, &format!("content-range: {place}")),
            "{}",
            part.head
        );
        assert_eq!(sent(&part.head), count, "{range}");
        if range == "bytes=4-7" {
            assert_eq!(part.body, "ftyp");
        }
    }
    page.stranger().get(&path).with(403);
    page.get_as(&path, &[("Host", "evil.example")]).with(403);
    for path in [
        format!("/api/video/{at}/left/2"),
        format!("/api/video/{at}/middle/0"),
        format!("/api/video/{at}/left/-1"),
        format!("/api/video/{at}/left/..%2f..%2fetc%2fpasswd"),
    ] {
        let status = page.get(&path).status;
        assert!([400, 404].contains(&status), "{path}: {status}");
    }
    page.say(&scene, json!({"say": "left"})).with(204);
    page.until("asking");
    assert_eq!(page.get(&path).with(204).body, "", "that question is over");
    assert!(kill(child));
}
