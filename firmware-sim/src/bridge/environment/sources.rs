//! The worker's Python files and its locked requirements, carried inside this program so that it works from anywhere.

use std::fs;
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU64, Ordering};

use super::error::SetupError;
use crate::disk::{self, Disk, WriteError};

/// The script that a worker process runs.
pub(super) const WORKER: &str = "worker.py";
/// The script with the steps of an installation.
pub(super) const INSTALL: &str = "install.py";
/// The requirements that the environment is made from.
pub(super) const REQUIREMENTS: &str = "requirements.lock";

/// The files that decide how a state looks in a picture.
const DRAWING: [&str; 3] = ["cameras.py", "render.py", REQUIREMENTS];

/// The package that `ted doctor` asks the registry for: a few kilobytes.
pub(super) const SMALL_PACKAGE: &str = "zipp";

macro_rules! carried {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_str!(concat!("../../../metaworld-bridge/", $name)))),*]
    };
}

pub(super) const FILES: [(&str, &str); 18] = carried!(
    "cameras.py",
    "collect.py",
    "fast.py",
    "install.py",
    "messages.py",
    "pairs.py",
    "parent.py",
    "quick.py",
    "rebound.py",
    "render.py",
    "requirements.lock",
    "scalars.py",
    "session.py",
    "snapshot.py",
    "speed.py",
    "task.py",
    "wire.py",
    "worker.py",
);

/// The script of the worker for a world of one's own.
pub(super) const OWN_WORKER: &str = "own_worker.py";

/// The files of a worker for a world in Python that speaks with this program. It needs no package.
pub const WORKER_KIT: [(&str, &str); 4] = [
    (OWN_WORKER, include_str!("../../../own-world/own_worker.py")),
    (
        "messages.py",
        include_str!("../../../metaworld-bridge/messages.py"),
    ),
    (
        "parent.py",
        include_str!("../../../metaworld-bridge/parent.py"),
    ),
    ("wire.py", include_str!("../../../metaworld-bridge/wire.py")),
];

/// The digest of what decides how a state looks in a picture.
pub(super) fn drawing_digest() -> String {
    digest(FILES.iter().filter(|(name, _)| DRAWING.contains(name)))
}

/// Puts the files of a worker, [`WORKER_KIT`] and these, into a folder of their own in this one, and returns that.
pub(super) fn write_worker(
    folder: &Path,
    name: &str,
    files: &[(&str, &str)],
) -> Result<PathBuf, SetupError> {
    let files = [&WORKER_KIT[..], files].concat();
    let name = format!("{name}-{}", &digest(files.iter())[..16]);
    put(folder.join(name), &files)
}

/// Puts files into a folder whose name holds their digest.
///
/// A program of another version finds its own files untouched, and a reader never sees half of them.
pub(super) fn put(folder: PathBuf, files: &[(&str, &str)]) -> Result<PathBuf, SetupError> {
    /// Tells the threads of this process apart.
    static NEXT: AtomicU64 = AtomicU64::new(0);
    if folder.is_dir() {
        return Ok(folder);
    }
    let writer = (process::id(), NEXT.fetch_add(1, Ordering::Relaxed));
    let beside = folder.with_extension(format!("{}-{}", writer.0, writer.1));
    if let Err(error) = write_new(&beside, files).and_then(|()| disk::rename(&beside, &folder)) {
        // What was begun would keep space. It may be gone already, or never have come to exist.
        fs::remove_dir_all(&beside).ok();
        // If the folder is there, somebody else was faster, with the same files.
        if !folder.is_dir() {
            return Err(error.into());
        }
    }
    Ok(folder)
}

fn write_new(folder: &Path, files: &[(&str, &str)]) -> Result<(), WriteError> {
    disk::create_folder(folder)?;
    for (name, text) in files {
        Disk::REAL.write(&folder.join(name), text.as_bytes())?;
    }
    disk::sync_folder(folder)
}

/// The digest of files, names included.
pub(super) fn digest<'a>(files: impl Iterator<Item = &'a (&'a str, &'a str)>) -> String {
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
        assert!(super::super::SIMULATOR.locked_packages() >= 17);
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
        let write = || put(venv.path().join("files"), &FILES);
        let first = write()?;
        assert_eq!(write()?, first);
        for (name, text) in FILES {
            assert_eq!(fs::read_to_string(first.join(name))?, text);
        }
        assert_eq!(fs::read_dir(venv.path())?.count(), 1);
        Ok(())
    }

    #[test]
    fn threads_that_write_at_once_all_find_whole_files() -> Result<(), Box<dyn std::error::Error>> {
        let venv = tempfile::tempdir()?;
        std::thread::scope(|scope| {
            let writers: Vec<_> = (0..8)
                .map(|_| scope.spawn(|| put(venv.path().join("files"), &FILES)))
                .collect();
            for writer in writers {
                let folder = writer.join().expect("no panic").expect("it is written");
                for (name, text) in FILES {
                    assert_eq!(
                        fs::read_to_string(folder.join(name)).ok().as_deref(),
                        Some(text)
                    );
                }
            }
        });
        assert_eq!(fs::read_dir(venv.path())?.count(), 1);
        Ok(())
    }
}
