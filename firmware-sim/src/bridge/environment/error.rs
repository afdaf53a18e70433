//! Why the Python side could not be set up, and the way out of each.

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::PYTHON_VARIABLE;
use super::python::{NEWEST, OLDEST};

use crate::disk::WriteError;
use crate::exit::ExitCode;

/// The variables that name other places: of the simulator, and of the reader of logs.
const PLACES: &str = "TED_METAWORLD_VENV (for `ted import` TED_READER_VENV)";

/// Why the environment could not be set up.
#[derive(Debug, Error)]
pub enum SetupError {
    /// There is no such interpreter.
    #[error(
        "find {python}: install Python {}.{} to {}.{}, or name one with {PYTHON_VARIABLE}=/path/to/python3",
        OLDEST.0, OLDEST.1, NEWEST.0, NEWEST.1
    )]
    NoPython {
        /// What was looked for.
        python: PathBuf,
    },
    /// The interpreter does not work.
    #[error(
        "run {python}: it failed: {words}; name another one with {PYTHON_VARIABLE}=/path/to/python3"
    )]
    BrokenPython {
        /// The interpreter.
        python: PathBuf,
        /// What it said.
        words: String,
    },
    /// The locked packages have no wheels for this Python.
    #[error(
        "use {python}: it is Python {}.{}, the simulator needs {}.{} to {}.{}; \
         name another one with {PYTHON_VARIABLE}=/path/to/python3",
        actual.0, actual.1, OLDEST.0, OLDEST.1, NEWEST.0, NEWEST.1
    )]
    PythonVersion {
        /// The interpreter.
        python: PathBuf,
        /// Its version.
        actual: (u32, u32),
    },
    /// The interpreter comes without `venv` and `ensurepip`, as Debian's does.
    #[error(
        "create a virtual environment with {python}: it has no venv module; \
         on Debian and Ubuntu: apt install python{}.{}-venv",
        version.0, version.1
    )]
    NoVenv {
        /// The interpreter.
        python: PathBuf,
        /// Its version.
        version: (u32, u32),
    },
    /// There is no place for the environment.
    #[error(
        "find a cache folder: neither HOME nor XDG_CACHE_HOME is set; name a place with {PLACES}"
    )]
    NoHome,
    /// The place is taken by something that this program did not make.
    #[error(
        "install into {path}: there is something else; empty it, or name another place with {PLACES}"
    )]
    NotOurs {
        /// The place.
        path: PathBuf,
    },
    /// The disk is full.
    #[error(
        "install the simulator into {path}: the disk is full, about 700 MB are needed; free some, or name another place with {PLACES}"
    )]
    DiskFull {
        /// Where the environment goes.
        path: PathBuf,
    },
    /// A file or folder could not be written.
    #[error("{what} {path}: {source}; name another place with {PLACES}")]
    Storage {
        /// What was attempted.
        what: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// The worker's files could not be written.
    #[error("write the simulator's files: {0}; or name another place with {PLACES}")]
    Write(#[from] WriteError),
    /// The package registry cannot be reached.
    #[error(
        "download the simulator: the package registry cannot be reached; check the network and pip's proxy settings, then run this again:\n{words}"
    )]
    Network {
        /// The installer's last lines.
        words: String,
    },
    /// A package is not the one that was locked.
    #[error(
        "trust a downloaded package: its hash is not the locked one; a proxy or mirror may have changed it:\n{words}"
    )]
    Hash {
        /// The installer's last lines.
        words: String,
    },
    /// There are no built packages for this machine.
    #[error(
        "find packages for this machine: the simulator exists for Linux and macOS on x86-64 and 64-bit ARM:\n{words}"
    )]
    NoPackage {
        /// The installer's last lines.
        words: String,
    },
    /// A step failed for a reason of its own.
    #[error("{step}: it failed; its last lines:\n{words}")]
    Failed {
        /// The step of the installation.
        step: &'static str,
        /// The installer's last lines.
        words: String,
    },
    /// The person asked to stop.
    #[error("stopped on request; the next command starts the installation again")]
    Interrupted,
}

impl SetupError {
    /// Tells a full disk from other trouble with files.
    pub(super) fn storage(what: &'static str, path: &Path, source: io::Error) -> Self {
        let path = path.to_owned();
        if matches!(
            source.kind(),
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded
        ) {
            Self::DiskFull { path }
        } else {
            Self::Storage { what, path, source }
        }
    }

    /// Finds out from the output of a failed step what went wrong.
    pub(super) fn of_step(step: &'static str, venv: &Path, output: &[String]) -> Self {
        let said = |patterns: &[&str]| {
            output
                .iter()
                .any(|line| patterns.iter().any(|pattern| line.contains(pattern)))
        };
        let words = output[output.len().saturating_sub(12)..].join("\n");
        // The words are in the person's language; the numbers are ENOSPC, and EDQUOT of Linux and of macOS.
        if said(&[
            "No space left on device",
            "Disk quota exceeded",
            "[Errno 28]",
            "[Errno 122]",
            "[Errno 69]",
        ]) {
            Self::DiskFull {
                path: venv.to_owned(),
            }
        } else if said(&["DO NOT MATCH THE HASHES"]) {
            Self::Hash { words }
        } else if said(&[
            "connection broken by",
            "ConnectionError",
            "NewConnectionError",
            "Temporary failure in name resolution",
            "Failed to establish a new connection",
            "ReadTimeout",
            "ProxyError",
            "SSLError",
        ]) {
            Self::Network { words }
        } else if said(&["No matching distribution found", "is not a supported wheel"]) {
            Self::NoPackage { words }
        } else {
            Self::Failed { step, words }
        }
    }

    /// The exit status for a command that ends with this error.
    #[must_use]
    pub const fn exit_code(&self) -> ExitCode {
        match self {
            Self::DiskFull { .. } | Self::Storage { .. } | Self::Write(_) => ExitCode::Storage,
            Self::Interrupted => ExitCode::Interrupted,
            _ => ExitCode::Environment,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(line: &str) -> SetupError {
        SetupError::of_step(
            "install",
            Path::new("/venv"),
            &[line.to_owned(), "and more".to_owned()],
        )
    }

    #[test]
    fn the_installer_s_output_is_told_apart() {
        let network =
            "WARNING: Retrying (Retry(total=1)) after connection broken by 'NewConnectionError'";
        assert!(matches!(of(network), SetupError::Network { .. }));
        assert!(matches!(
            of("OSError: [Errno 28] No space left on device"),
            SetupError::DiskFull { .. }
        ));
        assert!(matches!(
            of(
                "ERROR: Could not install packages due to an OSError: [Errno 28] Auf dem Gerät ist kein Speicherplatz mehr verfügbar"
            ),
            SetupError::DiskFull { .. }
        ));
        let hash = "ERROR: THESE PACKAGES DO NOT MATCH THE HASHES FROM THE REQUIREMENTS FILE.";
        assert!(matches!(of(hash), SetupError::Hash { .. }));
        let none = "ERROR: No matching distribution found for mujoco==3.3.0";
        assert!(matches!(of(none), SetupError::NoPackage { .. }));
        assert!(
            matches!(of("Segmentation fault"), SetupError::Failed { words, .. } if words.ends_with("and more"))
        );
    }

    #[test]
    fn a_full_disk_is_storage_and_no_network_is_environment() {
        assert_eq!(of("No space left on device").exit_code(), ExitCode::Storage);
        assert_eq!(of("ConnectionError").exit_code(), ExitCode::Environment);
    }
}
