//! Where datasets and runs are when a person does not say.

use std::path::{Path, PathBuf};

use firmware_sim::exit::ExitCode;
use firmware_sim::failure::Failure;
use firmware_sim::worlds;

use crate::collect::NAMESPACE;
use crate::config::Config;
use crate::dataset::{Dataset, DatasetError};
use crate::run::{DATASET, DatasetReference, RunFolder};
use crate::train::TrainError;

use super::failures::end;

/// The folder that Minari keeps its datasets in: `$MINARI_DATASETS_PATH`, or `~/.minari/datasets`.
pub(super) fn datasets_root() -> PathBuf {
    let home = || {
        std::env::home_dir()
            .unwrap_or_default()
            .join(".minari")
            .join("datasets")
    };
    std::env::var_os("MINARI_DATASETS_PATH")
        .filter(|p| !p.is_empty())
        .map_or_else(home, PathBuf::from)
}

/// Opens what a person calls a dataset: a folder, a Minari id such as `ted/drawer-open-v3-paper-s0-v0`, or a task,
/// which means the dataset that `ted collect --task` writes when it is told nothing else.
pub(super) fn open_dataset(name: &str) -> Result<(Dataset, PathBuf), Failure> {
    let path = dataset_path(name);
    match Dataset::open(&path) {
        Ok(dataset) => Ok((dataset, path)),
        Err(error) => Err(no_dataset(name, error)),
    }
}

/// Why what a person calls by this name cannot be opened, and what else may be meant.
pub(super) fn no_dataset(name: &str, error: DatasetError) -> Failure {
    match (&error, collected(name).as_slice()) {
        (DatasetError::NotFound { .. }, others @ [_, ..]) => Failure::new(
            ExitCode::BadInput,
            format_args!("{error}; of this name there are: {}", others.join(", ")),
        ),
        _ => end(error),
    }
}

/// Ids of the collected datasets whose name begins with this, such as those of a task that are not the full one of seed 0.
fn collected(name: &str) -> Vec<String> {
    let folders = std::fs::read_dir(datasets_root().join(NAMESPACE));
    let mut ids: Vec<String> = folders
        .into_iter()
        .flatten()
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|folder| !name.is_empty() && folder.starts_with(name))
        .map(|folder| format!("{NAMESPACE}/{folder}"))
        .collect();
    ids.sort();
    ids
}

/// The artefact of a run.
pub(super) fn artefact_of(folder: &RunFolder) -> Result<PathBuf, Failure> {
    let path = folder.artefact_path();
    if path.exists() {
        return Ok(path);
    }
    let config = Config::read(&folder.config_path()).map_err(end)?;
    if !config.algorithm.makes_networks() {
        return Err(end(TrainError::NotForControllers {
            folder: folder.path().to_path_buf(),
            algorithm: config.algorithm.name(),
        }));
    }
    Err(Failure::new(
        ExitCode::BadInput,
        format_args!(
            "the run in {} has no policy.ted: the same `ted train` command finishes it, and `ted export` makes the artefact \
             of a finished run again",
            folder.path().display()
        ),
    ))
}

/// The path itself if there is something, and otherwise the dataset that a person may mean by it.
pub(super) fn existing_or_dataset(path: &Path) -> PathBuf {
    match path.to_str() {
        Some(name) if !path.exists() => Some(dataset_path(name)).filter(|path| path.exists()),
        _ => None,
    }
    .unwrap_or_else(|| path.to_path_buf())
}

/// The dataset that a run was trained on: where the run found it, where Minari keeps it, or where a person says it is now.
pub(super) fn dataset_of(folder: &RunFolder, named: Option<&str>) -> Result<Dataset, Failure> {
    located(folder, named).map(|(_, dataset)| dataset)
}

/// The same, with the folder that it is in.
pub(super) fn located(
    folder: &RunFolder,
    named: Option<&str>,
) -> Result<(PathBuf, Dataset), Failure> {
    let reference: DatasetReference = folder.read_json(DATASET).map_err(end)?;
    let path = match named {
        Some(named) => dataset_path(named),
        None if reference.path.exists() => reference.path,
        None => datasets_root().join(&reference.id),
    };
    let dataset = Dataset::open(&path).map_err(|error| match error {
        DatasetError::NotFound { .. } => Failure::new(
            ExitCode::BadInput,
            format_args!(
                "the dataset {} of the run is not at {}: say with --dataset where it is now",
                reference.id,
                path.display()
            ),
        ),
        error => end(error),
    })?;
    if dataset.digest() == reference.digest {
        Ok((path, dataset))
    } else {
        Err(Failure::new(
            ExitCode::BadInput,
            format_args!(
                "the run in {} was trained on {} with digest {}, and {} has digest {}: name the right one with --dataset",
                folder.path().display(),
                reference.id,
                reference.digest,
                path.display(),
                dataset.digest()
            ),
        ))
    }
}

/// Where the dataset of this name is, if it is there.
pub(super) fn dataset_path(name: &str) -> PathBuf {
    let path = Path::new(name);
    if path.exists() {
        path.to_path_buf()
    } else if worlds::single(name).is_ok_and(|task| task.collection().is_some()) {
        datasets_root()
            .join(NAMESPACE)
            .join(format!("{name}-paper-s0-v0"))
    } else {
        datasets_root().join(name)
    }
}

/// `<root>/<task>/<preset>/seed-<seed>`; the root is `runs` if none is given.
pub(super) fn run_folder(root: Option<&Path>, task: &str, preset: &str, seed: u64) -> PathBuf {
    root.unwrap_or(Path::new("runs"))
        .join(task)
        .join(preset)
        .join(format!("seed-{seed}"))
}
