//! The folder of a run, held by one process at a time.

use std::fs::File;
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::config::{Config, ConfigError};
use firmware_sim::disk::{self, WriteError};

use super::sealed::{self, SealedError};
use super::{Checkpoint, ForeignCheckpoint};

/// Checkpoints kept: the newest, and the one before in case the newest is damaged.
const KEPT_CHECKPOINTS: usize = 2;

/// Which dataset a run was trained on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DatasetReference {
    /// `namespace/name-vN`.
    pub id: String,
    /// Digest of its arrays.
    pub digest: String,
    /// Where it was.
    pub path: PathBuf,
}

/// Why a run folder cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The folder holds a run with another configuration or dataset.
    #[error(
        "{folder} holds another run ({difference}): choose another folder with --out, or delete this one"
    )]
    OtherRun {
        /// The folder.
        folder: PathBuf,
        /// What differs.
        difference: String,
    },
    /// There is no finished run in the folder.
    #[error("{path} does not exist: is this the folder of a run? `ted train` makes one")]
    Missing {
        /// What was looked for.
        path: PathBuf,
    },
    /// A file of the run does not parse.
    #[error("{path} is not readable: {message}")]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the parser said.
        message: String,
    },
    /// Its configuration does not parse.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// Its checkpoint cannot be used.
    #[error(transparent)]
    Checkpoint(#[from] ForeignCheckpoint),
    /// One of its state files cannot be used.
    #[error(transparent)]
    State(#[from] SealedError),
    /// The disk.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// A run folder.
#[derive(Debug)]
pub struct RunFolder {
    path: PathBuf,
    /// Held as long as the run is open for writing.
    lock: Option<File>,
}

impl RunFolder {
    /// Opens a folder to train in: makes it, or goes on with what it holds if that is the same run.
    ///
    /// # Errors
    /// When another process works there, when it holds another run, or when the disk fails.
    pub fn begin(
        path: &Path,
        config: &Config,
        dataset: &DatasetReference,
    ) -> Result<Self, RunError> {
        disk::create_folder(&path.join("checkpoints"))?;
        let folder = Self {
            path: path.to_path_buf(),
            lock: Some(disk::lock(path)?),
        };
        let other = |difference: String| RunError::OtherRun {
            folder: path.to_path_buf(),
            difference,
        };
        let config_path = folder.config_path();
        if config_path.exists() {
            let held = Config::read(&config_path)?;
            if held != *config {
                return Err(other(format!(
                    "its config.toml differs: {}",
                    first_difference(&held, config)
                )));
            }
        } else {
            disk::replace(&config_path, config.to_toml().as_bytes())?;
        }
        if folder.file("dataset.json").exists() {
            let held: DatasetReference = folder.read_json("dataset.json")?;
            if held.digest != dataset.digest {
                return Err(other(format!(
                    "it was trained on {} with digest {}",
                    held.id, held.digest
                )));
            }
        }
        folder.write_json("dataset.json", dataset)?;
        Ok(folder)
    }

    /// Opens a folder to read from.
    ///
    /// # Errors
    /// When it is not the folder of a run.
    pub fn open(path: &Path) -> Result<Self, RunError> {
        let folder = Self {
            path: path.to_path_buf(),
            lock: None,
        };
        let config = folder.config_path();
        if config.exists() {
            Ok(folder)
        } else {
            Err(RunError::Missing { path: config })
        }
    }

    /// Whether this process may write here.
    #[must_use]
    pub fn is_held(&self) -> bool {
        self.lock.is_some()
    }

    /// Where it is.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// A file in it.
    #[must_use]
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// The resolved configuration.
    #[must_use]
    pub fn config_path(&self) -> PathBuf {
        self.file("config.toml")
    }

    /// The artefact.
    #[must_use]
    pub fn artefact_path(&self) -> PathBuf {
        self.file("policy.ted")
    }

    /// Writes a value as JSON, in one step.
    ///
    /// # Errors
    /// When the disk is full or fails.
    ///
    /// # Panics
    /// Never: what a run records is plain data.
    pub fn write_json(&self, name: &str, value: &impl Serialize) -> Result<(), WriteError> {
        let mut text =
            serde_json::to_string_pretty(value).expect("what a run records is plain data");
        text.push('\n');
        disk::replace(&self.file(name), text.as_bytes())
    }

    /// Reads a value back.
    ///
    /// # Errors
    /// When the file is missing or does not parse.
    pub fn read_json<T: DeserializeOwned>(&self, name: &str) -> Result<T, RunError> {
        let path = self.file(name);
        let text =
            std::fs::read_to_string(&path).map_err(|_| RunError::Missing { path: path.clone() })?;
        serde_json::from_str(&text).map_err(|e| RunError::Unreadable {
            path,
            message: e.to_string(),
        })
    }

    /// Writes a value as a state file, in one step.
    ///
    /// # Errors
    /// When the disk is full or fails.
    pub fn write_state(&self, name: &str, value: &impl Serialize) -> Result<(), WriteError> {
        disk::replace(&self.file(name), &sealed::seal(value))
    }

    /// Reads a state file back.
    ///
    /// # Errors
    /// When the file is missing or damaged.
    pub fn read_state<T: DeserializeOwned>(&self, name: &str) -> Result<T, SealedError> {
        sealed::read(&self.file(name))
    }

    /// Saves a learner, then removes all but the newest checkpoints.
    ///
    /// # Errors
    /// When the disk is full or fails; the checkpoints before stay as they were.
    pub fn save(&self, checkpoint: &Checkpoint) -> Result<(), WriteError> {
        let path = self
            .path
            .join("checkpoints")
            .join(format!("{:012}.checkpoint", checkpoint.step));
        disk::replace(&path, &sealed::seal(checkpoint))?;
        for old in self.checkpoints().iter().rev().skip(KEPT_CHECKPOINTS) {
            std::fs::remove_file(old).map_err(|source| WriteError::at(old, source))?;
        }
        Ok(())
    }

    /// The newest checkpoint that can be read; a damaged one is passed over with a note to `warn`.
    pub fn newest_checkpoint(&self, mut warn: impl FnMut(&SealedError)) -> Option<Checkpoint> {
        self.checkpoints()
            .iter()
            .rev()
            .find_map(|path| sealed::read(path).inspect_err(&mut warn).ok())
    }

    fn checkpoints(&self) -> Vec<PathBuf> {
        let entries = std::fs::read_dir(self.path.join("checkpoints"));
        let mut paths: Vec<PathBuf> = entries
            .into_iter()
            .flatten()
            .flatten()
            .map(|e| e.path())
            .collect();
        paths.retain(|p| p.extension().is_some_and(|e| e == "checkpoint"));
        paths.sort();
        paths
    }
}

/// The first line in which two configurations differ.
fn first_difference(held: &Config, wanted: &Config) -> String {
    let (held, wanted) = (held.to_toml(), wanted.to_toml());
    let differing = held.lines().zip(wanted.lines()).find(|(a, b)| a != b);
    differing.map_or_else(
        || "one has more fields".to_owned(),
        |(a, b)| format!("`{a}` there, `{b}` asked for"),
    )
}
