//! The worker's Python files and its locked requirements, carried inside this program so that it works from anywhere.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process;

use super::error::SetupError;

/// The script that a worker process runs.
pub(super) const WORKER: &str = "worker.py";
/// The script with the steps of an installation.
pub(super) const INSTALL: &str = "install.py";
/// The requirements that the environment is made from.
pub(super) const REQUIREMENTS: &str = "requirements.lock";

/// The package that `ted doctor` asks the registry for: a few kilobytes.
pub(super) const SMALL_PACKAGE: &str = "zipp";

macro_rules! carried {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_str!(concat!("../../../metaworld-bridge/", $name)))),*]
    };
}

const FILES: [(&str, &str); 12] = carried!(
    "collect.py",
    "install.py",
    "messages.py",
    "parent.py",
    "quick.py",
    "requirements.lock",
    "session.py",
    "snapshot.py",
    "speed.py",
    "task.py",
    "wire.py",
    "worker.py",
);

/// The digest of the locked requirements, which names the environment made from them.
pub(super) fn lock_digest() -> String {
    let lock = FILES.iter().filter(|(name, _)| *name == REQUIREMENTS);
    digest(lock)
}

/// How many packages the lock file holds, for progress.
pub(super) fn locked_packages() -> u64 {
    let lock = FILES
        .iter()
        .find(|(name, _)| *name == REQUIREMENTS)
        .map_or("", |(_, text)| text);
    let mut names: Vec<_> = lock
        .lines()
        .filter_map(|line| Some(line.split_once("==")?.0))
        .collect();
    names.dedup();
    names.len() as u64
}

/// Puts the files into the environment, under a name that holds their digest, and returns their folder.
///
/// A program of another version finds its own files untouched, and a reader never sees half of them.
pub(super) fn write(venv: &Path) -> Result<PathBuf, SetupError> {
    let digest = digest(FILES.iter());
    let folder = venv.join(format!("bridge-{}", &digest[..16]));
    if folder.is_dir() {
        return Ok(folder);
    }
    let beside = venv.join(format!("bridge-{}.{}", &digest[..16], process::id()));
    write_new(&beside)
        .and_then(|()| match fs::rename(&beside, &folder) {
            // Another process was faster, with the same files.
            Err(_) if folder.is_dir() => fs::remove_dir_all(&beside),
            renamed => renamed,
        })
        .map_err(|source| SetupError::storage("write the simulator's files to", &folder, source))?;
    Ok(folder)
}

fn write_new(folder: &Path) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    FILES
        .iter()
        .try_for_each(|(name, text)| fs::write(folder.join(name), text))
}

fn digest<'a>(files: impl Iterator<Item = &'a (&'a str, &'a str)>) -> String {
    let mut hasher = blake3::Hasher::new();
    for (name, text) in files {
        hasher.update(name.as_bytes()).update(&[0]);
        hasher.update(text.as_bytes()).update(&[0]);
    }
    hasher.finalize().to_hex().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lock_names_each_package_with_a_hash() {
        let (_, lock) = FILES
            .iter()
            .find(|(name, _)| *name == REQUIREMENTS)
            .expect("the lock is carried");
        assert!(locked_packages() >= 17);
        let blocks = lock
            .split("\n    # via")
            .filter(|block| block.contains("=="));
        assert!(
            blocks
                .into_iter()
                .all(|block| block.contains("--hash=sha256:"))
        );
        assert!(!lock.contains("://"), "the lock names no host");
    }

    #[test]
    fn files_are_written_once_and_found_again() -> Result<(), Box<dyn std::error::Error>> {
        let venv = tempfile::tempdir()?;
        let first = write(venv.path())?;
        assert_eq!(write(venv.path())?, first);
        assert_eq!(fs::read_to_string(first.join(WORKER))?, FILES[11].1);
        assert_eq!(fs::read_dir(venv.path())?.count(), 1);
        Ok(())
    }
}
