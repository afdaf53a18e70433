//! More answers than a run wanted at first. The number is part of its configuration, and stands in its folder before the next
//! question is asked.

use std::path::Path;

use crate::config::Config;
use crate::run::{DatasetReference, RunError, RunFolder};
use crate::train::has_learned;

/// Answers that somebody gives who wishes for more; the words say how many, too.
pub(super) const MORE: usize = 5;

/// Opens a run's folder to ask in it. Where it holds the same run with another number of answers, the larger one counts: what was
/// asked before it is the same. Returns the configuration that the folder has then.
///
/// # Errors
/// When the folder cannot be opened, holds another run, or has learned from fewer answers than are wanted now.
pub fn begin(
    path: &Path,
    config: &Config,
    dataset: &DatasetReference,
) -> Result<(RunFolder, Config), RunError> {
    let Some(held) = held(path).filter(|held| config.asking(held.answers()) == *held) else {
        return Ok((RunFolder::begin(path, config, dataset)?, config.clone()));
    };
    let folder = RunFolder::begin(path, &held, dataset)?;
    if held.answers() >= config.answers() {
        return Ok((folder, held));
    }
    if has_learned(&folder) {
        let difference = format!(
            "it has learned from {} answers, and {} are wanted",
            held.answers(),
            config.answers()
        );
        return Err(folder.other(difference));
    }
    folder.reconfigure(config)?;
    Ok((folder, config.clone()))
}

/// The configuration in a folder; none where there is none that can be read.
fn held(path: &Path) -> Option<Config> {
    let folder = RunFolder::open(path).ok()?;
    Config::read(&folder.config_path()).ok()
}
