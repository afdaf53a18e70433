//! The folder of a run, held by one process at a time.

use std::fmt::Display;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::checkpoint::{Checkpoint, ForeignCheckpoint};
use crate::config::{Config, ConfigError};
use firmware_sim::disk::{self, WriteError};
use firmware_sim::progress::Audience;

use super::sealed::{self, SealedError};

/// Every question asked, and its answer.
pub const PREFERENCES: &str = "preferences.jsonl";

/// What became of every line of a file of answers.
pub const ANSWERS: &str = "answers.json";

/// Which dataset the run is trained on.
pub const DATASET: &str = "dataset.json";

/// How the policy flew.
pub const EVALUATION: &str = "evaluation.json";

/// What the integer networks of the artefact cost.
pub const QUANTISATION: &str = "quantisation.json";

/// What became of the run, on one page.
pub const REPORT: &str = "report.html";

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
    siblings: Vec<PathBuf>,
    /// Held as long as the run is open for writing.
    _lock: Option<File>,
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
            siblings: Vec::new(),
            _lock: Some(disk::lock(path)?),
        };
        if !Self::holds(path, config)? {
            folder.reconfigure(config)?;
        }
        if folder.file(DATASET).exists() {
            let held: DatasetReference = folder.read_json(DATASET)?;
            if held.digest != dataset.digest {
                return Err(folder.other(format!(
                    "it was trained on {} with digest {}",
                    held.id, held.digest
                )));
            }
        }
        folder.write_json(DATASET, dataset)?;
        Ok(folder)
    }

    /// Takes this configuration in place of the one that the folder holds, as long as nothing was learned by that.
    ///
    /// # Errors
    /// When the disk is full or fails; the folder then holds the one that it held.
    pub fn reconfigure(&self, config: &Config) -> Result<(), WriteError> {
        disk::replace(&self.config_path(), config.to_toml().as_bytes())
    }

    /// Whether the run of this configuration was begun in the folder; false when no run was.
    ///
    /// # Errors
    /// When it holds another run, or a configuration that cannot be read.
    pub fn holds(path: &Path, config: &Config) -> Result<bool, RunError> {
        let folder = match Self::open(path) {
            Ok(folder) => folder,
            Err(RunError::Missing { .. }) => return Ok(false),
            Err(error) => return Err(error),
        };
        let held = Config::read(&folder.config_path())?;
        if held == *config {
            Ok(true)
        } else {
            let mut difference = first_difference(&held, config);
            let more = held.answers() > config.answers();
            if more && config.asking(held.answers()) == held {
                difference.push_str(", and --ask goes on with the answers that are there");
            }
            Err(folder.other(format!("its config.toml differs: {difference}")))
        }
    }

    /// The error for a run that is not the one in this folder.
    #[must_use]
    pub fn other(&self, difference: String) -> RunError {
        RunError::OtherRun {
            folder: self.path.clone(),
            difference,
        }
    }

    /// Opens a folder to read from.
    ///
    /// # Errors
    /// When it is not the folder of a run.
    pub fn open(path: &Path) -> Result<Self, RunError> {
        let folder = Self {
            path: path.to_path_buf(),
            siblings: Vec::new(),
            _lock: None,
        };
        let config = folder.config_path();
        if config.exists() {
            Ok(folder)
        } else {
            Err(RunError::Missing { path: config })
        }
    }

    /// The same folder among others, whose runs may have learned what this one is to learn.
    #[must_use]
    pub fn among(self, siblings: Vec<PathBuf>) -> Self {
        Self { siblings, ..self }
    }

    /// Folders of runs that may have learned what this one is to learn.
    #[must_use]
    pub fn siblings(&self) -> &[PathBuf] {
        &self.siblings
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

    /// Puts the artefact of the run in its place. An evaluation of other bytes is gone before these are there: what
    /// `evaluation.json` says is about `policy.ted`.
    ///
    /// # Errors
    /// When the disk is full or fails.
    pub fn write_artefact(&self, bytes: &[u8]) -> Result<(), WriteError> {
        let (artefact, evaluation) = (self.artefact_path(), self.file(EVALUATION));
        if std::fs::read(&artefact).is_ok_and(|held| held == bytes) {
            return Ok(());
        }
        match std::fs::remove_file(&evaluation) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                Err(WriteError::at(&evaluation, error))
            }
            _ => disk::replace(&artefact, bytes),
        }
    }

    /// Saves a learner, then removes all but the newest checkpoints. A later one goes too: this learner did not start
    /// from it, so it could not be used.
    ///
    /// # Errors
    /// When the disk is full or fails; the checkpoints before stay as they were.
    pub fn save(&self, checkpoint: &Checkpoint) -> Result<(), WriteError> {
        let path = self
            .path
            .join("checkpoints")
            .join(format!("{:012}.checkpoint", checkpoint.step));
        disk::replace(&path, &sealed::seal(checkpoint))?;
        let (saved, later): (Vec<_>, Vec<_>) =
            self.checkpoints().into_iter().partition(|p| *p <= path);
        let earlier = saved.iter().rev().skip(KEPT_CHECKPOINTS);
        for useless in later.iter().chain(earlier) {
            std::fs::remove_file(useless).map_err(|source| WriteError::at(useless, source))?;
        }
        Ok(())
    }

    /// The newest checkpoint of this configuration that can be read; any other is passed over with a note.
    #[must_use]
    pub fn newest_checkpoint(&self, config: &Config, audience: Audience) -> Option<Checkpoint> {
        let pass_over = |why: &dyn Display| audience.note(&format!("pass over: {why}"));
        let digest = config.digest();
        self.checkpoints().iter().rev().find_map(|path| {
            let checkpoint: Checkpoint = sealed::read(path).inspect_err(|e| pass_over(e)).ok()?;
            if checkpoint.config_digest == digest {
                return Some(checkpoint);
            }
            pass_over(&format_args!(
                "{} belongs to another configuration",
                path.display()
            ));
            None
        })
    }

    /// Whether a learner was ever saved.
    #[must_use]
    pub fn has_checkpoints(&self) -> bool {
        !self.checkpoints().is_empty()
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Preset;

    fn begin(path: &Path, config: &Config) -> RunFolder {
        let dataset = DatasetReference {
            id: "ted/x-v0".to_owned(),
            digest: String::new(),
            path: PathBuf::new(),
        };
        RunFolder::begin(path, config, &dataset).unwrap()
    }

    fn at(config: &Config, step: u64) -> Checkpoint {
        Checkpoint {
            config_digest: config.digest(),
            step,
            tensors: Vec::new(),
        }
    }

    fn steps(folder: &RunFolder) -> Vec<u64> {
        let stem = |path: PathBuf| path.file_stem()?.to_str()?.parse().ok();
        folder.checkpoints().into_iter().filter_map(stem).collect()
    }

    #[test]
    fn a_checkpoint_outlives_later_ones_that_could_not_be_used() {
        let temporary = tempfile::tempdir().unwrap();
        let config = Preset::True.config();
        let folder = begin(temporary.path(), &config);
        let newest = || {
            let newest = folder.newest_checkpoint(&config, Audience::Nobody);
            newest.map(|checkpoint| checkpoint.step)
        };
        for step in [80, 90, 100] {
            folder.save(&at(&config, step)).unwrap();
        }
        assert_eq!((steps(&folder), newest()), (vec![90, 100], Some(100)));
        for path in folder.checkpoints() {
            std::fs::write(path, b"damaged").unwrap();
        }
        assert_eq!(newest(), None);
        folder.save(&at(&config, 10)).unwrap();
        assert_eq!((steps(&folder), newest()), (vec![10], Some(10)));
        folder.save(&at(&config, 20)).unwrap();
        assert_eq!((steps(&folder), newest()), (vec![10, 20], Some(20)));
    }

    #[test]
    fn a_checkpoint_of_another_configuration_is_passed_over_for_the_one_before() {
        let temporary = tempfile::tempdir().unwrap();
        let (config, other) = (Preset::True.config(), Preset::Zero.config());
        let folder = begin(temporary.path(), &config);
        folder.save(&at(&config, 10)).unwrap();
        folder.save(&at(&other, 20)).unwrap();
        let newest = folder.newest_checkpoint(&config, Audience::Nobody);
        assert_eq!(newest, Some(at(&config, 10)));
    }

    #[test]
    fn who_asks_for_fewer_answers_than_a_folder_has_is_told_how_to_keep_them() {
        let temporary = tempfile::tempdir().unwrap();
        let config = Preset::Steer.config();
        let folder = begin(temporary.path(), &config);
        let way_out = |config: &Config| {
            let refused = RunFolder::holds(temporary.path(), config).unwrap_err();
            refused.to_string().contains("--ask goes on")
        };
        assert!(!way_out(&config.asking(15)));
        folder.reconfigure(&config.asking(15)).unwrap();
        assert!(RunFolder::holds(temporary.path(), &config.asking(15)).unwrap());
        assert!(way_out(&config));
        let other = Config { seed: 1, ..config };
        assert!(!way_out(&other));
    }

    #[test]
    fn an_evaluation_does_not_outlive_the_artefact_that_flew() {
        let temporary = tempfile::tempdir().unwrap();
        let folder = begin(temporary.path(), &Preset::True.config());
        folder.write_artefact(b"one").unwrap();
        folder.write_json(EVALUATION, &"of one").unwrap();
        folder.write_artefact(b"one").unwrap();
        assert!(folder.file(EVALUATION).exists());
        folder.write_artefact(b"two").unwrap();
        assert!(!folder.file(EVALUATION).exists());
        assert_eq!(std::fs::read(folder.artefact_path()).unwrap(), b"two");
    }
}
