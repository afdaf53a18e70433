//! Datasets that a fleet collects itself, each just before the first run that wants it: those of a long study fill the disk one
//! after the other, and whoever stops it early never has the others.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use firmware_sim::bridge::Engine;
use firmware_sim::disk::{self, WriteError};
use firmware_sim::interrupt;

use super::LaneError;
use crate::collect::{CollectConfig, CollectError, run_anywhere};
use crate::dataset::minari;
use crate::train::Watch;

/// Between two looks at a dataset that another process collects.
const PAUSE: Duration = Duration::from_millis(200);

/// How the datasets are made that may be missing, by their folders.
#[derive(Debug, Default)]
pub(super) struct Collecting {
    configs: HashMap<PathBuf, CollectConfig>,
    /// One at a time: each takes all cores.
    turn: Mutex<()>,
}

impl Collecting {
    /// Of these, by their folders.
    pub(super) fn of(configs: HashMap<PathBuf, CollectConfig>) -> Self {
        Self {
            configs,
            turn: Mutex::default(),
        }
    }

    /// Collects the dataset in this folder, if it is one of these and not there; waits if somebody else does.
    pub(super) fn complete(&self, folder: &Path, watch: Watch<'_>) -> Result<(), LaneError> {
        let Some(config) = self.configs.get(folder) else {
            return Ok(());
        };
        if minari::is_finished(folder) {
            return Ok(());
        }
        // Who panicked meanwhile left a dataset that is not finished, as a kill does.
        let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        disk::create_folder(folder).map_err(CollectError::from)?;
        let mut waiting = false;
        while !minari::is_finished(folder) {
            if interrupt::requested() {
                return Err(LaneError::NotBegun);
            }
            match collect(config, folder, watch) {
                Err(CollectError::Write(WriteError::Busy { .. })) => {
                    if !waiting {
                        watch.note(&format!(
                            "another process collects {}: waiting for it",
                            folder.display()
                        ));
                    }
                    waiting = true;
                    thread::sleep(PAUSE);
                }
                end => return Ok(end?),
            }
        }
        Ok(())
    }
}

fn collect(config: &CollectConfig, folder: &Path, watch: Watch<'_>) -> Result<(), CollectError> {
    // Asked first, because a collection starts a simulator before it finds the folder locked.
    drop(disk::lock(folder)?);
    watch.note(&format!(
        "collect {} episodes of {} into {}",
        config.episode_count(),
        config.task,
        folder.display()
    ));
    let report = run_anywhere(config, Engine::default(), watch.beside())?;
    watch.note(&format!("collected {}", report.dataset));
    Ok(())
}

#[cfg(test)]
mod tests {
    use firmware_sim::progress::Audience;

    use super::*;
    use crate::collect::Recipe;

    fn toy(root: &Path) -> CollectConfig {
        CollectConfig {
            task: "toy".to_owned(),
            recipe: Recipe::Paper,
            episodes: Some(3),
            good: None,
            seed: 0,
            workers: 1,
            root: root.to_owned(),
        }
    }

    #[test]
    fn what_is_missing_is_collected_once_by_whoever_comes_first_and_the_others_wait() {
        let root = tempfile::tempdir().unwrap();
        let config = toy(root.path());
        let folder = config.folder().unwrap();
        // Two processes have nothing in common but the folder.
        let [one, other] =
            [(); 2].map(|()| Collecting::of(HashMap::from([(folder.clone(), config.clone())])));
        thread::scope(|scope| {
            for fleet in [&one, &one, &other, &other] {
                let folder = &folder;
                scope.spawn(move || fleet.complete(folder, Audience::Nobody.into()).unwrap());
            }
        });
        assert!(minari::is_finished(&folder));
    }

    #[test]
    fn what_somebody_else_holds_is_waited_for() {
        let root = tempfile::tempdir().unwrap();
        let config = toy(root.path());
        let folder = config.folder().unwrap();
        disk::create_folder(&folder).unwrap();
        let fleet = Collecting::of(HashMap::from([(folder.clone(), config.clone())]));
        let held = disk::lock(&folder).unwrap();
        thread::scope(|scope| {
            let waits = scope.spawn(|| fleet.complete(&folder, Audience::Nobody.into()));
            // It cannot have begun, however long the scheduler takes.
            assert!(!waits.is_finished() && !folder.join("data").exists());
            drop(held);
            waits.join().unwrap().unwrap();
        });
        assert!(minari::is_finished(&folder));
    }

    #[test]
    fn a_dataset_of_nobody_s_plan_is_left_to_whoever_opens_it() {
        let nowhere = Path::new("/nowhere");
        let fleet = Collecting::default();
        fleet.complete(nowhere, Audience::Nobody.into()).unwrap();
        assert!(!nowhere.exists());
    }
}
