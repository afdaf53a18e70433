//! Writing that survives a kill: bytes reach the disk before a name points at them.

use std::fs::{self, File, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::exit::ExitCode;
use crate::size::Size;

/// Why something could not be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The device or the quota is full.
    #[error(
        "no space left while writing {path}: free some and run the same command again; what is complete is kept ({source})"
    )]
    DiskFull {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// Less space than will be needed.
    #[error("{what} needs about {needed} on the disk, and {free} are free at {path}: {way_out}")]
    NoRoom {
        /// What is to be written.
        what: String,
        /// Where to.
        path: PathBuf,
        /// What it takes.
        needed: Size,
        /// What there is.
        free: Size,
        /// What to do about it.
        way_out: &'static str,
    },
    /// Any other failure of the file system.
    #[error("cannot write {path}: {source}; make its folder writable, or choose another place")]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// Another process is writing there.
    #[error("another process is writing to {path}: wait for it, or choose another folder or seed")]
    Busy {
        /// The folder.
        path: PathBuf,
    },
    /// The folder holds something else than what is to be written.
    #[error(
        "{path} was begun differently: {difference}; choose another folder, or delete it to start anew"
    )]
    Different {
        /// The folder.
        path: PathBuf,
        /// What differs.
        difference: String,
    },
}

impl WriteError {
    /// A failure of the file system at `path`.
    #[must_use]
    pub fn at(path: &Path, source: io::Error) -> Self {
        let path = path.to_path_buf();
        match source.kind() {
            io::ErrorKind::StorageFull
            | io::ErrorKind::QuotaExceeded
            | io::ErrorKind::FileTooLarge => Self::DiskFull { path, source },
            _ => Self::Io { path, source },
        }
    }

    /// How a command ends that fails with this error.
    #[must_use]
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::DiskFull { .. } | Self::NoRoom { .. } | Self::Io { .. } => ExitCode::Storage,
            Self::Busy { .. } => ExitCode::Busy,
            Self::Different { .. } => ExitCode::BadInput,
        }
    }
}

/// The file system, with the two operations that tests replace.
#[derive(Clone, Copy, Debug)]
pub struct Disk {
    create: fn(&Path) -> io::Result<File>,
    free: fn(&Path) -> Option<u64>,
}

impl Disk {
    /// The one that is there.
    pub const REAL: Self = Self {
        create: |path| File::create(path),
        free: free_space,
    };

    /// One that opens files for writing in another way: how a test fills it up.
    #[must_use]
    pub fn with_create(create: fn(&Path) -> io::Result<File>) -> Self {
        Self {
            create,
            ..Self::REAL
        }
    }

    /// One that has so many bytes left.
    #[must_use]
    pub fn with_free(free: fn(&Path) -> Option<u64>) -> Self {
        Self { free, ..Self::REAL }
    }

    /// Refuses to begin what would not fit. Where the system does not say what is free, everything is begun.
    ///
    /// # Errors
    /// [`WriteError::NoRoom`] when `needed` bytes are more than there are where `path` is or will be.
    pub fn require(
        self,
        path: &Path,
        needed: f64,
        what: &str,
        way_out: &'static str,
    ) -> Result<(), WriteError> {
        match (self.free)(path) {
            Some(free) if needed > free as f64 => Err(WriteError::NoRoom {
                what: what.to_owned(),
                path: path.to_path_buf(),
                needed: Size(needed),
                free: Size(free as f64),
                way_out,
            }),
            _ => Ok(()),
        }
    }

    /// Writes a file and waits until it is on the disk.
    ///
    /// # Errors
    /// When the disk is full or fails.
    pub fn write(self, path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
        self.fill(path, bytes)
            .map_err(|error| WriteError::at(path, error))
    }

    fn fill(self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        let mut file = (self.create)(path)?;
        file.write_all(bytes)?;
        file.sync_all()
    }

    /// Puts `bytes` in the place of `path` in one step: a reader sees the old file or the new one.
    ///
    /// # Errors
    /// When the disk is full or fails; the old file is untouched then.
    pub fn replace(self, path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
        let mut name = std::ffi::OsString::from(".");
        name.push(path.file_name().unwrap_or_default());
        name.push(".tmp");
        let temporary = path.with_file_name(name);
        self.fill(&temporary, bytes)
            .map_err(|error| WriteError::at(path, error))
            .and_then(|()| rename(&temporary, path))
            .inspect_err(|_| {
                // What was begun would keep the space that is missing. It may never have come to exist.
                let _ = fs::remove_file(&temporary);
            })
    }
}

/// Bytes that this user may still write where `path` is or will be; none where the system does not say.
#[must_use]
pub fn free_space(path: &Path) -> Option<u64> {
    let path = std::path::absolute(path).ok()?;
    let there = path.ancestors().find(|path| path.exists())?;
    let disk = rustix::fs::statvfs(there).ok()?;
    disk.f_bavail.checked_mul(disk.f_frsize)
}

/// Renames inside one folder and waits until the new name is on the disk.
///
/// # Errors
/// When the disk is full or fails.
pub fn rename(from: &Path, to: &Path) -> Result<(), WriteError> {
    fs::rename(from, to).map_err(|error| WriteError::at(to, error))?;
    match to.parent() {
        Some(folder) if folder.as_os_str().is_empty() => sync_folder(Path::new(".")),
        Some(folder) => sync_folder(folder),
        None => Ok(()),
    }
}

/// Waits until the names inside a folder are on the disk.
///
/// # Errors
/// When the disk is full or fails.
pub fn sync_folder(folder: &Path) -> Result<(), WriteError> {
    File::open(folder)
        .and_then(|folder| folder.sync_all())
        .map_err(|error| WriteError::at(folder, error))
}

/// Creates a folder and those above it.
///
/// # Errors
/// When the disk is full or fails.
pub fn create_folder(folder: &Path) -> Result<(), WriteError> {
    fs::create_dir_all(folder).map_err(|error| WriteError::at(folder, error))
}

/// Whether a file could be put in the place of `path`: to know before long work, not after.
///
/// # Errors
/// When its folder is missing or cannot be written.
pub fn check_writable(path: &Path) -> Result<(), WriteError> {
    let probe = path.with_file_name(format!(".ted-probe-{}", std::process::id()));
    fs::write(&probe, b"")
        .and_then(|()| fs::remove_file(&probe))
        .map_err(|error| WriteError::at(path, error))
}

/// Locks `folder` against a second writer for as long as the returned file lives.
///
/// # Errors
/// [`WriteError::Busy`] when another process holds the lock.
pub fn lock(folder: &Path) -> Result<File, WriteError> {
    let path = folder.join(".writer.lock");
    let file = File::create(&path).map_err(|error| WriteError::at(&path, error))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(WriteError::Busy {
            path: folder.to_path_buf(),
        }),
        Err(TryLockError::Error(error)) => Err(WriteError::at(&path, error)),
    }
}

/// Puts `bytes` in the place of `path` in one step on the real disk.
///
/// # Errors
/// As [`Disk::replace`].
pub fn replace(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    Disk::REAL.replace(path, bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_would_not_fit_is_refused_with_how_much_where_and_the_way_out() {
        let disk = Disk::with_free(|_| Some(3_000_000));
        let place = Path::new("/data/mine");
        let begin = |bytes| disk.require(place, bytes, "recording it", "free some");
        assert!(begin(3_000_000.0).is_ok());
        let refused = begin(3_000_001.0).unwrap_err();
        assert_eq!(
            refused.to_string(),
            "recording it needs about 3.0 MB on the disk, and 3.0 MB are free at /data/mine: free some"
        );
        assert_eq!(refused.exit_code(), ExitCode::Storage);
        // Where nobody says how much there is, it is tried.
        let unknown = Disk::with_free(|_| None);
        assert!(unknown.require(place, 1e300, "it", "").is_ok());
    }

    #[test]
    fn a_folder_that_is_not_there_yet_has_the_space_of_the_one_that_will_hold_it() {
        let folder = tempfile::tempdir().unwrap();
        let free = free_space(&folder.path().join("not/there"));
        assert!(free.is_some_and(|bytes| bytes > 0), "{free:?}");
    }
}
