//! The `ted` command as a process: run to its end, or watched and killed.

use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

use tempfile::TempDir;

/// A small run: every phase, nothing that takes long, no flight.
pub const SMALL: [&str; 12] = [
    "algorithm.hidden=[32, 32]",
    "algorithm.batch=16",
    "algorithm.steps=60",
    "schedule.log_every=3",
    "schedule.checkpoint_every=7",
    "schedule.evaluation_episodes=0",
    "reward.hidden=[16]",
    "reward.segment=10",
    "reward.pool=50",
    "reward.epochs=20",
    "reward.held_out=50",
    "reward.output=linear",
];

/// What a finished command said and how it ended.
#[derive(Debug)]
pub struct Ended {
    pub code: Option<i32>,
    pub said: String,
    pub told: String,
}

impl Ended {
    /// Fails with everything that was said unless the command ended with this code.
    #[track_caller]
    pub fn with(self, code: i32) -> Self {
        assert_eq!(self.code, Some(code), "{}{}", self.said, self.told);
        self
    }

    /// Fails unless standard error says this.
    #[track_caller]
    pub fn telling(self, part: &str) -> Self {
        assert!(self.told.contains(part), "no {part:?} in: {}", self.told);
        self
    }
}

/// A folder with a dataset and room for runs.
pub struct Desk {
    pub folder: TempDir,
}

impl Desk {
    /// An empty one.
    pub fn new() -> Self {
        Self {
            folder: tempfile::tempdir().unwrap(),
        }
    }

    /// One with a small dataset at [`Self::dataset`].
    pub fn with_dataset() -> Self {
        let desk = Self::new();
        crate::dataset::write(
            desk.folder.path(),
            "plain",
            &crate::dataset::episodes(6, 30),
        );
        desk
    }

    pub fn dataset(&self) -> PathBuf {
        self.folder.path().join("ted/plain-v0")
    }

    pub fn run(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// `ted train` on the dataset into `out`, small; `sets` come after the small settings.
    pub fn train(&self, out: &str, preset: &str, sets: &[&str]) -> Command {
        self.train_on(&self.dataset(), out, preset, sets)
    }

    pub fn train_on(&self, dataset: &Path, out: &str, preset: &str, sets: &[&str]) -> Command {
        let learns = preset.starts_with("oprl");
        // Its networks have no hidden layers, and its shape is the test's choice.
        let layers = preset != "oppo";
        let mut command = ted();
        command
            .current_dir(self.folder.path())
            .arg("train")
            .arg(dataset)
            .args(["--preset", preset, "--out", out]);
        let applies = |set: &&&str| {
            (learns || !set.starts_with("reward.")) && (layers || !set.contains(".hidden="))
        };
        for set in SMALL.iter().filter(applies).chain(sets) {
            command.args(["--set", set]);
        }
        command
    }
}

/// The command under test.
pub fn ted() -> Command {
    Command::new(env!("CARGO_BIN_EXE_ted"))
}

/// Runs a command to its end.
pub fn finish(command: &mut Command) -> Ended {
    heard(command.output().unwrap())
}

/// The command under a shell that lets no file grow beyond this many blocks of 512 bytes.
pub fn limited(command: &Command, blocks: u32) -> Command {
    let mut shell = Command::new("sh");
    // Ignored, the signal leaves the write to fail as it does on a full disk.
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"");
    shell.args(["-c", &script]);
    shell.arg(command.get_program()).args(command.get_args());
    shell.current_dir(command.get_current_dir().unwrap());
    shell
}

/// Waits for the end of a command whose output is caught.
pub fn ended(child: Child) -> Ended {
    heard(child.wait_with_output().unwrap())
}

fn heard(output: Output) -> Ended {
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    Ended {
        code: output.status.code(),
        said: text(output.stdout),
        told: text(output.stderr),
    }
}

/// Starts a command and waits until it has come far enough, or has ended. How far beyond `reached` it is when it is caught
/// is up to the machine. A test that needs it caught at work leaves it seconds of work, thousands of looks, beyond that.
pub fn start_until(command: &mut Command, reached: impl Fn() -> bool) -> Child {
    let mut child = command
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    while !reached() && child.try_wait().unwrap().is_none() {
        std::thread::park_timeout(Duration::from_micros(200));
    }
    child
}

/// `kill -9`; says whether the process was still at work.
pub fn kill(mut child: Child) -> bool {
    child.kill().unwrap();
    child.wait().unwrap().signal() == Some(9)
}

/// Asks a process to stop.
pub fn terminate(child: &Child) {
    let asked = Command::new("kill")
        .args(["-TERM", &child.id().to_string()])
        .status();
    assert!(asked.unwrap().success());
}

/// Complete lines of a file, none if it does not exist.
pub fn lines(path: &Path) -> usize {
    std::fs::read(path).map_or(0, |bytes| bytes.iter().filter(|&&b| b == b'\n').count())
}

/// The checkpoints of a run, oldest first.
pub fn checkpoints(run: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(run.join("checkpoints"));
    let mut paths: Vec<PathBuf> = entries
        .into_iter()
        .flatten()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "checkpoint"))
        .collect();
    paths.sort();
    paths
}

/// What a run is judged by: everything that does not hold a path or a clock.
pub fn outcome(run: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files: Vec<String> = ["metrics.jsonl", "config.toml", "reward.json"]
        .map(str::to_owned)
        .to_vec();
    files.extend(
        ["policy.ted", "preferences.jsonl", "reward.state"]
            .into_iter()
            .filter(|name| run.join(name).exists())
            .map(str::to_owned),
    );
    let last = checkpoints(run).pop().unwrap();
    let last = last.strip_prefix(run).unwrap().display().to_string();
    files.push(last);
    let read = |name: String| {
        let bytes = std::fs::read(run.join(&name)).unwrap();
        (name, bytes)
    };
    files.into_iter().map(read).collect()
}

/// Fails with the name of the first file in which two runs differ.
#[track_caller]
pub fn assert_same_outcome(one: &Path, other: &Path) {
    let (one, other) = (outcome(one), outcome(other));
    assert_eq!(one.len(), other.len());
    for ((name, bytes), (other_name, other_bytes)) in one.iter().zip(&other) {
        assert_eq!(name, other_name);
        assert!(bytes == other_bytes, "{name} differs");
    }
}
