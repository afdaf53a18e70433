//! Scores of whole runs: every combination of task, preset and seed, trained and flown, in one resumable table.

use std::path::{Path, PathBuf};

use crate::config::{ConfigError, Overrides, Preset};

use super::cells;
use super::fill::{self, Making, StudyError};
use super::run::{RunScore, StudyRun};

/// Every combination once, seed by seed, so that an unfinished study has something of every row; `locate` finds the datasets.
///
/// # Errors
/// Names a change that cannot be made.
pub fn runs(
    datasets: &[String],
    presets: &[Preset],
    seeds: &[u64],
    sets: &[String],
    out: &Path,
    locate: impl Fn(&str) -> PathBuf,
) -> Result<Vec<StudyRun>, ConfigError> {
    let changes = sets
        .iter()
        .try_fold(Overrides::default(), |all, set| all.set(set))?;
    changes.meant_for(presets)?;
    let mut runs = Vec::new();
    for &seed in seeds {
        for dataset in datasets {
            for &preset in presets {
                let folder = out.join(dataset.replace('/', "_")).join(preset.name());
                let run = StudyRun {
                    dataset: dataset.clone(),
                    place: locate(dataset),
                    collect: None,
                    config: changes.resolve(Some(preset), Some(seed))?,
                    folder: folder.join(format!("seed-{seed}")),
                };
                // A name that was given twice is a slip of the finger; counted twice, its spread would look too small.
                if !runs.contains(&run) {
                    runs.push(run);
                }
            }
        }
    }
    Ok(runs)
}

/// Trains and flies what has no score yet.
///
/// # Errors
/// As [`fill::fill`], and when the file cannot be read.
pub fn fill(making: Making<'_>, runs: &[StudyRun]) -> Result<(), StudyError> {
    let known: Vec<RunScore> = cells::read(making.scores)?;
    fill::fill(making, runs, &known, |_, score| {
        cells::append(making.scores, &score)
    })
}

/// The scores of these runs, as far as they are finished, those that were not written down yet included.
///
/// # Errors
/// When the file cannot be read.
pub fn scores(path: &Path, runs: &[StudyRun]) -> Result<Vec<RunScore>, StudyError> {
    let known: Vec<RunScore> = cells::read(path)?;
    let found = runs.iter().filter_map(|run| {
        let written = known.iter().find(|score| run.came_to(score));
        written.cloned().or_else(|| run.read())
    });
    Ok(found.collect())
}

#[cfg(test)]
mod tests;
