//! Environments that run `metaworld-bridge/fake_worker.py` in one of its modes.

use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::thread;
use std::time::{Duration, Instant};

use firmware_sim::bridge::environment::interpreter;
use firmware_sim::bridge::{Behaviour, Environment, EpisodeJob};
use tempfile::TempDir;

/// A folder in which fake workers run, and what they leave there.
pub struct Fake {
    folder: TempDir,
}

impl Fake {
    pub fn new(mode: &str) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        fs::write(folder.path().join("mode"), mode).expect("the mode is written");
        Self { folder }
    }

    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    pub fn environment(&self) -> Environment {
        environment(self.path())
    }

    /// How many workers were started.
    pub fn starts(&self) -> usize {
        self.lines("starts")
    }

    /// How many workers are in the middle of an episode that never ends.
    pub fn busy(&self) -> usize {
        self.lines("busy")
    }

    fn lines(&self, file: &str) -> usize {
        fs::read_to_string(self.path().join(file)).map_or(0, |lines| lines.lines().count())
    }

    /// Whether all workers end within a few seconds.
    pub fn all_ended(&self) -> bool {
        let alive = File::create(self.path().join("alive")).expect("the lock file can be opened");
        within_seconds(10, || match alive.try_lock() {
            Ok(()) => true,
            Err(TryLockError::WouldBlock) => false,
            Err(TryLockError::Error(error)) => panic!("{error}"),
        })
    }
}

/// The environment of fake workers in a folder that has a mode.
pub fn environment(folder: &Path) -> Environment {
    Environment::custom(&python(), &bridge().join("fake_worker.py"), folder)
}

/// The interpreter that the bridge itself would choose.
pub fn python() -> PathBuf {
    static PYTHON: LazyLock<PathBuf> = LazyLock::new(|| match interpreter() {
        Ok(interpreter) => interpreter.path,
        Err(error) => panic!("failed to {error}"),
    });
    PYTHON.clone()
}

pub fn bridge() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("metaworld-bridge")
}

pub fn job(seed: u64) -> EpisodeJob {
    EpisodeJob {
        task: "fake-v3".to_owned(),
        behaviour: Behaviour::EXPERT,
        seed,
        steps: 20,
    }
}

/// Looks again and again until something is so, or the time is over. What is waited for happens in another process.
pub fn within_seconds(seconds: u64, mut is_so: impl FnMut() -> bool) -> bool {
    let deadline = Instant::now() + Duration::from_secs(seconds);
    loop {
        if is_so() {
            return true;
        }
        if Instant::now() > deadline {
            return false;
        }
        thread::sleep(Duration::from_millis(5));
    }
}
