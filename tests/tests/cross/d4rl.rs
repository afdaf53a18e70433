//! D4RL's tasks, from a file of its layout to a flight and the paper's score beside it. The numbers in the files are drawn here: they have
//! the sizes of the real ones, and nothing is to be learned from them.

use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::binaries::{command, said};

/// A file as D4RL writes it: `ROWS` transitions, an episode ends after every 100th.
const MAKE: &str = r#"
import sys
import h5py
import numpy
chance = numpy.random.default_rng(0)
name, observation, action, maze = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), sys.argv[4] == "maze"
rows = 600
seen = chance.normal(size=(rows + 1, observation)).astype(numpy.float32)
ends = numpy.arange(1, rows + 1) % 100 == 0
rewards = ends.astype(numpy.float32) if maze else chance.normal(size=rows).astype(numpy.float32)
with h5py.File(name, "w") as file:
    file["observations"] = seen[:-1]
    file["actions"] = chance.uniform(-1, 1, (rows, action)).astype(numpy.float32)
    file["rewards"] = rewards
    file["terminals"] = ends & maze
    file["timeouts"] = ends & (not maze)
    file["next_observations"] = seen[1:]
"#;

const MAZE: &str = "Ant_maze_u-maze_noisy_multistart_False_multigoal_False_sparse_fixed.hdf5";

fn ted(at: &Path, arguments: &[&str]) -> Command {
    let mut ted = command("ted");
    ted.current_dir(at)
        .args(arguments)
        .env("MINARI_DATASETS_PATH", at.join("data"))
        .env("TED_READER_VENV", reader());
    ted
}

fn reader() -> std::path::PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("reader")
}

#[test]
fn d4rl_s_files_become_the_rows_of_the_paper_s_table() {
    let desk = tempfile::tempdir().unwrap();
    let at = desk.path();
    // The reader of such files is what makes them, once it is installed; there is nothing to read yet.
    said(&mut ted(at, &["import", "none.hdf5", "--describe"]), &[3]);
    for (name, observation, action, kind) in [
        ("hopper_medium-v2.hdf5", "11", "3", "open"),
        ("ant-expert-v2.hdf5", "111", "8", "open"),
        (MAZE, "29", "8", "maze"),
    ] {
        let made = Command::new(reader().join("bin/python"))
            .current_dir(at)
            .args(["-Es", "-c", MAKE, name, observation, action, kind])
            .output()
            .unwrap();
        assert!(made.status.success(), "{made:?}");
    }
    let study = [
        "study",
        "d4rl",
        ".",
        "--seeds",
        "0",
        "--presets",
        "random",
        "--set",
        "algorithm.steps=20",
        "--set",
        "schedule.evaluation_episodes=2",
        "--json",
    ];
    let scores: Vec<Value> = serde_json::from_str(&said(&mut ted(at, &study), &[0])).unwrap();
    let names: Vec<_> = scores
        .iter()
        .map(|it| it["dataset"].as_str().unwrap())
        .collect();
    let expected = [
        "d4rl/hopper-medium-v2",
        "d4rl/ant-expert-v2",
        "d4rl/antmaze-umaze-v2",
    ];
    assert_eq!(names, expected);
    for (score, (low, high)) in
        scores
            .iter()
            .zip([(-20.272_305, 3234.3), (-325.6, 3879.7), (0.0, 1.0)])
    {
        let flown = &score["evaluation"];
        let number = |key: &str| flown[key].as_f64().unwrap();
        assert_eq!(flown["returns"].as_array().unwrap().len(), 2);
        let score = (number("return_mean") - low) / (high - low);
        assert!((number("score") - score).abs() < 1e-12, "{flown}");
    }
    // What is D4RL's in the maze alone: a reward of -1 a step, and the constants of IQL.
    let maze = &scores[2]["config"];
    assert_eq!(maze["discount"]["shift"], -1.0, "{maze}");
    assert_eq!(maze["algorithm"]["tau"], 0.9, "{maze}");
    assert!(scores[0]["config"]["discount"].get("shift").is_none());
    // The table is printed again without a file or a run, and has the paper's score in it.
    let table = study.iter().copied().filter(|it| *it != "--json");
    let table: Vec<_> = table.chain(["--table"]).collect();
    let table = said(&mut ted(at, &table), &[0]);
    let row = table
        .lines()
        .find(|line| line.contains("hopper-medium-v2"))
        .unwrap();
    assert!(row.contains("0.53 ± 0.00"), "{row}");
}
