//! A robot of one's own, from its logs to a board: the example of `docs/own-world.md`, by the commands of `docs/your-robot.md`.

#[expect(dead_code, reason = "the tests of the page ask more of it")]
#[path = "../../../ted-train/tests/runs/ask/browser.rs"]
mod browser;

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use firmware_sim::bridge::environment::interpreter;
use serde_json::{Value, json};

use crate::binaries::{command, said};
use browser::Browser;

const EXAMPLE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../firmware-sim/own-world/example"
);

/// A seventh of the updates that are usual: the observation of the puck has six numbers and not thirty-nine, and 20 of 20 flights succeed
/// with them.
const SHORT: [&str; 3] = [
    "algorithm.steps=3000",
    "reward.clone.steps=2000",
    "reward.network.steps=2000",
];

/// A folder as a newcomer has it, with her world, her logs, and what is known of both.
fn desk() -> tempfile::TempDir {
    let desk = tempfile::tempdir().unwrap();
    for file in ["puck.py", "logs.py", "map.toml", "robot.toml"] {
        fs::copy(Path::new(EXAMPLE).join(file), desk.path().join(file)).unwrap();
    }
    let logs = said(python(desk.path()).arg("logs.py"), &[0]);
    fs::write(desk.path().join("logs.csv"), logs).unwrap();
    desk
}

fn python(at: &Path) -> Command {
    let mut python = Command::new(interpreter().unwrap().path);
    python.current_dir(at).arg("-B");
    python
}

fn ted(at: &Path, arguments: &[&str]) -> Command {
    let mut ted = command("ted");
    ted.current_dir(at)
        .env("MINARI_DATASETS_PATH", at.join("data"))
        .args(arguments);
    ted
}

/// How far the puck is from its goal when the clip of this side ends, by what the page is given to draw.
fn miss(page: &Browser, scene: &Value, side: &str) -> f64 {
    let path = format!("/api/clip/{}/{side}", scene["at"]);
    let clip: Value = serde_json::from_str(&page.get(&path).with(200).body).unwrap();
    let last = |name: &str| -> Vec<f64> {
        let places = clip["places"].as_array().unwrap();
        let place = places.iter().find(|place| place["name"] == name).unwrap();
        let axes = place["path"].as_array().unwrap().last().unwrap();
        let axes = axes.as_array().unwrap().iter();
        axes.map(|axis| axis.as_f64().unwrap()).collect()
    };
    let apart = last("puck").into_iter().zip(last("goal"));
    apart
        .map(|(puck, goal)| (puck - goal).powi(2))
        .sum::<f64>()
        .sqrt()
}

/// Trains, and answers ten questions on the page as somebody who likes the episode that ends nearer to its goal.
fn train_and_answer(at: &Path) {
    let mut train = ted(
        at,
        &[
            "train",
            "mine/puck-v0",
            "--out",
            "run",
            "--ask",
            "--by",
            "anna",
        ],
    );
    for set in SHORT {
        train.args(["--set", set]);
    }
    train.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = train.spawn().unwrap();
    let mut page = Browser::open(child.stderr.as_mut().unwrap());
    for number in 1..=10 {
        let scene = page.until("asking");
        assert_eq!([&scene["number"], &scene["of"]], [number, 10]);
        let [left, right] = ["left", "right"].map(|side| miss(&page, &scene, side));
        let better = if left < right { "left" } else { "right" };
        page.say(&scene, json!({"say": better})).with(204);
    }
    let scene = page.until("review");
    page.say(&scene, json!({"say": "done"})).with(204);
    assert_eq!(page.until("ended")["end"]["how"], "goes-on");
    let ended = child.wait_with_output().unwrap();
    let told = String::from_utf8_lossy(&ended.stderr);
    assert!(ended.status.success(), "{told}");
    let answers = fs::read_to_string(at.join("run/preferences.jsonl")).unwrap();
    assert_eq!(answers.matches("\"by\":\"anna\"").count(), 10, "{answers}");
}

/// The return of each of these episodes where half of either thruster's range is all that ever happens: the puck stays where it is.
fn returns_of_nothing(at: &Path, flown: &Value) -> Vec<f64> {
    let nothing = "import json, puck, sys\n\
        def flown(seed):\n    \
            world = puck.make()\n    \
            puck.reset(world, seed)\n    \
            return sum(puck.step(world, [0.5, 0.5])[1] for _ in range(puck.steps))\n\
        print(json.dumps([flown(int(seed)) for seed in sys.argv[1:]]))";
    let episodes = flown["episodes"].as_array().unwrap();
    let seeds = episodes.iter().map(|it| it["seed"].to_string());
    let returns = said(python(at).args(["-c", nothing]).args(seeds), &[0]);
    serde_json::from_str(&returns).unwrap()
}

#[test]
fn a_puck_at_30_hz_with_actions_from_0_to_1_flies_on_a_cortex_m_from_its_logs_and_ten_answers_on_the_page()
 {
    let desk = desk();
    let at = desk.path();
    let import = [
        "import",
        "logs.csv",
        "--map",
        "map.toml",
        "--as",
        "mine/puck-v0",
    ];
    said(&mut ted(at, &import), &[0]);
    said(
        &mut ted(at, &["robot", "declare", "mine/puck-v0", "robot.toml"]),
        &[0],
    );
    train_and_answer(at);

    let fly = |more: &[&str]| -> Value {
        let mut fly = command("firmware-sim");
        fly.current_dir(at)
            .args([
                "fly",
                "run/policy.ted",
                "--world",
                "puck.py",
                "--episodes",
                "5",
            ])
            .args(["--numeric", "integer", "--json"])
            .args(more);
        serde_json::from_str(&said(&mut fly, &[0])).unwrap()
    };
    let host = fly(&[]);
    let board = fly(&["--on", "mps2-an386"]);
    assert_eq!(
        (&host["faulted"], &board["faulted"]),
        (&json!(0), &json!(0))
    );
    assert_eq!(board["episodes"], host["episodes"], "to the bit");
    assert_eq!(board["success_rate"], 1.0, "{board}");
    for (flown, nothing) in
        (board["episodes"].as_array().unwrap().iter()).zip(returns_of_nothing(at, &board))
    {
        let flown = flown["return"].as_f64().unwrap();
        assert!(
            flown > nothing / 2.0,
            "{flown}, and {nothing} by doing nothing"
        );
    }

    // The run was never flown, so this flight is its own, and it is flown again to the bit.
    let eval = [
        "eval",
        "run",
        "--world",
        "puck.py",
        "--episodes",
        "3",
        "--json",
    ];
    let flown: Value = serde_json::from_str(&said(&mut ted(at, &eval), &[0])).unwrap();
    assert!(
        flown["world"].as_str().unwrap().ends_with("/puck.py"),
        "{flown}"
    );
    assert_eq!(flown["score"], Value::Null);
    let check = [
        "crosscheck",
        "run",
        "--episodes",
        "2",
        "--sample",
        "200",
        "--json",
    ];
    let check: Value = serde_json::from_str(&said(&mut ted(at, &check), &[0])).unwrap();
    let checks = check["checks"].as_array().unwrap();
    let again = checks.iter().find(|it| {
        it["what"]
            .as_str()
            .unwrap()
            .starts_with("returns, flown again")
    });
    assert_eq!(again.unwrap()["compared"], 2, "{check}");

    // The same at reduced size in one command, with the clone of the logs beside it.
    let quick = [
        "quickstart",
        "--dataset",
        "mine/puck-v0",
        "--world",
        "puck.py",
        "--steps",
        "40",
    ];
    let unasked = ted(at, &quick).output().unwrap();
    assert_eq!(
        unasked.status.code(),
        Some(3),
        "nobody can answer: {unasked:?}"
    );
    fs::write(at.join("keys"), "1\n".repeat(10) + "\n").unwrap();
    let keys = fs::File::open(at.join("keys")).unwrap();
    let asked = [&quick[..], &["--ask", "--text", "--json"]].concat();
    let report: Value = serde_json::from_str(&said(ted(at, &asked).stdin(keys), &[0])).unwrap();
    assert_eq!(
        (&report["rewarded"], &report["scripted"]),
        (&json!(false), &Value::Null)
    );
    for who in ["cloned", "trained"] {
        assert_eq!(
            report[who]["returns"].as_array().unwrap().len(),
            10,
            "{report}"
        );
    }
}
