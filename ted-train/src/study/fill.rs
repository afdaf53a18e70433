//! Makes what is missing of a study, as a fleet, and writes down each score as soon as it is known.
//!
//! What a run came to is a line in a file of scores, which outlives the run's folder and is small enough to take along: a study
//! of many hours goes on on any machine that has the file and the datasets.

use std::collections::{BTreeMap, HashMap};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use firmware_sim::disk::WriteError;
use firmware_sim::progress::Audience;

use crate::collect::CollectError;
use crate::config::ConfigError;
use crate::doctor::processor;
use crate::fleet::{self, Datasets, FleetError, Lane};
use crate::run::{RunError, RunFolder};

use super::cells::{self, CellsError};
use super::run::{RunScore, StudyRun};

/// Why a study stopped.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// A configuration that cannot be used.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// A dataset that cannot be named.
    #[error(transparent)]
    Collect(#[from] CollectError),
    /// A run's folder that holds another one.
    #[error(transparent)]
    Run(#[from] RunError),
    /// Scores of another dataset of the same name: they do not belong in one row.
    #[error(
        "scores of {name} are of a dataset with digest {held} and of one with {here}: collect the first one again, or keep the \
         scores of the other in another file than {scores} with --scores, and its runs in another folder with --out"
    )]
    OtherDataset {
        /// The dataset as it was asked for.
        name: String,
        /// The file.
        scores: PathBuf,
        /// The digest that was known first.
        held: String,
        /// The other one.
        here: String,
    },
    /// The file of scores.
    #[error(transparent)]
    Scores(#[from] CellsError),
    /// Runs that failed; the others were finished.
    #[error(transparent)]
    Fleet(#[from] FleetError),
}

impl From<WriteError> for StudyError {
    fn from(error: WriteError) -> Self {
        Self::Scores(error.into())
    }
}

/// How a study is made, whatever it studies.
#[derive(Clone, Copy, Debug)]
pub struct Making<'a> {
    /// The file that scores are written to.
    pub scores: &'a Path,
    /// Runs at a time; one for each core if none.
    pub jobs: Option<NonZeroUsize>,
    /// Who waits for it.
    pub audience: Audience,
}

/// Trains and flies those of these runs that are not among the `known` scores, in their order, and gives each score to `write`
/// as soon as there is one, with the place of its run.
///
/// # Errors
/// Before anything is begun, when a run without a score was begun in its folder with other settings, and when there are scores
/// of another dataset of the same name, or no place for these. Then the first failure of a run or of the disk; the other runs
/// are finished first.
pub fn fill(
    making: Making<'_>,
    runs: &[StudyRun],
    known: &[RunScore],
    write: impl Fn(usize, RunScore) -> Result<(), WriteError> + Sync,
) -> Result<(), StudyError> {
    // What a kill left finished and not written down, and what is to be made.
    let (mut found, mut missing) = (Vec::new(), Vec::new());
    for (place, run) in runs.iter().enumerate() {
        if known.iter().any(|score| run.came_to(score)) {
            continue;
        }
        RunFolder::holds(&run.folder, &run.config)?;
        match run.read() {
            Some(score) => found.push((place, score)),
            None => missing.push(place),
        }
    }
    let to_make = || missing.iter().map(|&place| &runs[place]);
    let collected = to_make().filter_map(|run| Some((run.place.clone(), run.collect.clone()?)));
    let datasets = Datasets::collecting(collected.collect());

    let digests = Digests::new(making.scores);
    // The simulator has other last bits on another processor, and so have logs that are recorded there.
    let recorded = |name: &str| {
        runs.iter()
            .any(|run| run.dataset == name && run.collect.is_some())
    };
    let agree = |name: &str, digest: &str, machine: &str| {
        digests.agree(name, digest, recorded(name).then_some(machine))
    };
    for score in known.iter().chain(found.iter().map(|(_, score)| score)) {
        agree(&score.dataset, &score.dataset_digest, &score.machine)?;
    }
    let places: BTreeMap<&str, &Path> = to_make()
        .map(|run| (run.dataset.as_str(), run.place.as_path()))
        .collect();
    for (name, place) in places {
        // One that cannot be read is the failure of its runs, if it is not collected first.
        if let Ok(dataset) = datasets.open(place) {
            agree(name, dataset.digest(), &processor())?;
        }
    }
    if !missing.is_empty() {
        cells::check_writable(making.scores)?;
    }
    for (place, score) in found {
        write(place, score)?;
    }
    if missing.is_empty() {
        return Ok(());
    }

    // A scored run whose folder is gone has no reward to give to another.
    let wanted = |place: &usize| missing.contains(place);
    let places: Vec<usize> = (0..runs.len())
        .filter(|place| wanted(place) || runs[*place].folder.exists())
        .collect();
    let mut lanes: Vec<Lane> = places.iter().map(|&place| runs[place].lane()).collect();
    fleet::introduce(&mut lanes);
    let lanes: Vec<Lane> = places
        .iter()
        .zip(lanes)
        .filter_map(|(place, lane)| wanted(place).then_some(lane))
        .collect();
    let failed = Mutex::new(None);
    let Making { jobs, audience, .. } = making;
    let ends = fleet::run(&lanes, &datasets, jobs, audience, |lane| {
        let place = missing[lane];
        let Some(score) = runs[place].read() else {
            return;
        };
        let agreed = agree(&score.dataset, &score.dataset_digest, &score.machine);
        if let Err(error) = agreed.and_then(|()| Ok(write(place, score)?)) {
            audience.note(&error.to_string());
            let mut failed = failed.lock().unwrap_or_else(PoisonError::into_inner);
            failed.get_or_insert(error);
        }
    });
    let failed = failed.into_inner().unwrap_or_else(PoisonError::into_inner);
    match (fleet::first_failure(&lanes, ends), failed) {
        (Some(error), _) => Err(error.into()),
        (None, Some(error)) => Err(error),
        (None, None) => Ok(()),
    }
}

/// Which data the name of a dataset stands for: that which was seen first.
pub(super) struct Digests<'s> {
    scores: &'s Path,
    held: Mutex<HashMap<(String, String), String>>,
}

impl<'s> Digests<'s> {
    /// Of a study whose scores are in this file.
    pub(super) fn new(scores: &'s Path) -> Self {
        let held = Mutex::default();
        Self { scores, held }
    }

    /// Refuses a name that stood for other data before, or, where a machine is named, on that machine.
    pub(super) fn agree(
        &self,
        name: &str,
        digest: &str,
        machine: Option<&str>,
    ) -> Result<(), StudyError> {
        let mut held = self.held.lock().unwrap_or_else(PoisonError::into_inner);
        let first = held
            .entry((name.to_owned(), machine.unwrap_or_default().to_owned()))
            .or_insert_with(|| digest.to_owned());
        match first == digest {
            true => Ok(()),
            false => Err(StudyError::OtherDataset {
                name: name.to_owned(),
                scores: self.scores.to_path_buf(),
                held: first.clone(),
                here: digest.to_owned(),
            }),
        }
    }
}
