//! Scores of whole runs: every combination of task, preset and seed, trained and flown, in one resumable table.
//!
//! The runs are a fleet. What one came to is a line in a file of scores, which outlives the run's folder and is small enough to
//! take along: a study of many hours goes on on any machine that has the file and the datasets.

use std::collections::{BTreeMap, BTreeSet};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use firmware_sim::progress::Audience;
use serde::{Deserialize, Serialize};

use crate::config::{Config, ConfigError, Overrides, Preset};
use crate::doctor::processor;
use crate::evaluate::Evaluation;
use crate::fleet::{self, Datasets, FleetError, Lane};
use crate::reward::quality::RewardQuality;
use crate::run::{DATASET, DatasetReference, EVALUATION, RunError, RunFolder, Spent};
use crate::train::RewardReport;

use super::cells::{self, CellsError};

/// One run of the study.
#[derive(Clone, Debug, PartialEq)]
pub struct PolicyRun {
    /// A dataset as `ted train` takes it.
    pub dataset: String,
    /// Everything that decides what it computes.
    pub config: Config,
}

/// What a finished run came to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PolicyScore {
    /// The dataset as it was asked for.
    pub dataset: String,
    /// Digest of its arrays.
    pub dataset_digest: String,
    /// Everything that decided what the run computed.
    pub config: Config,
    /// How it flew.
    pub evaluation: Evaluation,
    /// What its rewards were worth; none where there is no reward.
    pub quality: Option<RewardQuality>,
    /// How long it took, if somebody looked at the clock.
    pub minutes: Option<f64>,
    /// The processor that its score was written down on.
    pub machine: String,
}

/// Why a study of policies stopped.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// A configuration that cannot be used.
    #[error(transparent)]
    Config(#[from] ConfigError),
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

/// Every combination once, seed by seed, so that an unfinished study has something of every row.
///
/// # Errors
/// Names a change that cannot be made.
pub fn runs(
    datasets: &[String],
    presets: &[Preset],
    seeds: &[u64],
    sets: &[String],
) -> Result<Vec<PolicyRun>, ConfigError> {
    let changes = sets
        .iter()
        .try_fold(Overrides::default(), |all, set| all.set(set))?;
    changes.meant_for(presets)?;
    let mut runs = Vec::new();
    for &seed in seeds {
        for dataset in datasets {
            for &preset in presets {
                let run = PolicyRun {
                    dataset: dataset.clone(),
                    config: changes.resolve(Some(preset), Some(seed))?,
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

/// Trains and flies what has no score yet, as a fleet, and writes down each score as soon as it is known; `locate` finds the
/// datasets.
///
/// # Errors
/// Before anything is begun, when a run without a score was begun in its folder with other settings, and when there are scores
/// of another dataset of the same name, or no place for these. Then the first failure of a run or of the disk; the other runs
/// are finished first.
pub fn fill(
    out: &Path,
    scores: &Path,
    runs: &[PolicyRun],
    jobs: Option<NonZeroUsize>,
    locate: impl Fn(&str) -> PathBuf,
    audience: Audience,
) -> Result<(), StudyError> {
    let known: Vec<PolicyScore> = cells::read(scores)?;
    // What a kill left finished and not written down, and what is to be made.
    let (mut found, mut missing) = (Vec::new(), Vec::new());
    for run in runs.iter().filter(|run| run.score(&known).is_none()) {
        RunFolder::holds(&run.folder(out), &run.config)?;
        match run.read(out) {
            Some(score) => found.push(score),
            None => missing.push(run),
        }
    }
    let datasets = Datasets::default();
    let names: BTreeSet<&str> = missing.iter().map(|run| run.dataset.as_str()).collect();
    let mut digests = Vec::new();
    for name in names {
        // One that cannot be read is the failure of its runs.
        if let Ok(dataset) = datasets.open(&locate(name)) {
            digests.push((name, dataset.digest().to_owned()));
        }
    }
    let of_scores = known.iter().chain(&found);
    let of_scores = of_scores.map(|it| (it.dataset.as_str(), it.dataset_digest.as_str()));
    let here = digests
        .iter()
        .map(|(name, digest)| (*name, digest.as_str()));
    one_dataset_a_name(scores, of_scores.chain(here))?;
    if !missing.is_empty() {
        cells::check_writable(scores).map_err(CellsError::from)?;
    }
    for score in &found {
        cells::append(scores, score).map_err(CellsError::from)?;
    }

    // A scored run whose folder is gone has no reward to give to another.
    let present = runs.iter().filter(|run| {
        let folder = run.folder(out);
        folder.exists() || missing.contains(run)
    });
    let mut lanes: Vec<Lane> = present.map(|run| run.lane(out, &locate)).collect();
    fleet::introduce(&mut lanes);
    lanes.retain(|lane| missing.iter().any(|run| run.folder(out) == lane.folder));
    let failed = Mutex::new(None);
    let ends = fleet::run(&lanes, &datasets, jobs, audience, |place| {
        let written = match missing[place].read(out) {
            Some(score) => cells::append(scores, &score),
            None => Ok(()),
        };
        if let Err(error) = written {
            audience.note(&error.to_string());
            let mut failed = failed.lock().unwrap_or_else(PoisonError::into_inner);
            failed.get_or_insert(error);
        }
    });
    let failed = failed.into_inner().unwrap_or_else(PoisonError::into_inner);
    match (fleet::first_failure(&lanes, ends), failed) {
        (Some(error), _) => Err(error.into()),
        (None, Some(error)) => Err(CellsError::from(error).into()),
        (None, None) => Ok(()),
    }
}

/// Refuses names that stand for several datasets, from pairs of a name and a digest.
fn one_dataset_a_name<'a>(
    scores: &Path,
    datasets: impl Iterator<Item = (&'a str, &'a str)>,
) -> Result<(), StudyError> {
    let mut known = BTreeMap::new();
    for (name, digest) in datasets {
        let first = *known.entry(name).or_insert(digest);
        if first != digest {
            return Err(StudyError::OtherDataset {
                name: name.to_owned(),
                scores: scores.to_path_buf(),
                held: first.to_owned(),
                here: digest.to_owned(),
            });
        }
    }
    Ok(())
}

/// The scores of these runs, as far as they are finished, those that were not written down yet included.
///
/// # Errors
/// When the file cannot be read.
pub fn scores(out: &Path, path: &Path, runs: &[PolicyRun]) -> Result<Vec<PolicyScore>, StudyError> {
    let cells = cells::read(path)?;
    let found = runs.iter().filter_map(|run| match run.score(&cells) {
        Some(score) => Some(score.clone()),
        None => run.read(out),
    });
    Ok(found.collect())
}

impl PolicyRun {
    fn folder(&self, out: &Path) -> PathBuf {
        out.join(self.dataset.replace('/', "_"))
            .join(self.config.preset.name())
            .join(format!("seed-{}", self.config.seed))
    }

    fn lane(&self, out: &Path, locate: impl Fn(&str) -> PathBuf) -> Lane {
        Lane {
            dataset: locate(&self.dataset),
            config: self.config.clone(),
            folder: self.folder(out),
            answers: None,
            siblings: Vec::new(),
        }
    }

    /// Its score among these.
    fn score<'s>(&self, scores: &'s [PolicyScore]) -> Option<&'s PolicyScore> {
        let mut scores = scores.iter();
        scores.find(|score| score.dataset == self.dataset && score.config == self.config)
    }

    /// What its folder says, if it is finished and has flown as it was to fly.
    fn read(&self, out: &Path) -> Option<PolicyScore> {
        let path = self.folder(out);
        if !RunFolder::holds(&path, &self.config).ok()? {
            return None;
        }
        let folder = RunFolder::open(&path).ok()?;
        let dataset: DatasetReference = folder.read_json(DATASET).ok()?;
        let reward: RewardReport = folder.read_json("reward.json").ok()?;
        let evaluation: Evaluation = folder.read_json(EVALUATION).ok()?;
        let flown = (evaluation.seed, evaluation.returns.len());
        let episodes = self.config.schedule.evaluation_episodes as usize;
        if flown != (self.config.seed, episodes) {
            return None;
        }
        // The time of a reward that was taken from another run is in it. Hundredths: nobody reads more.
        let minutes = |spent: Spent| (spent.reward_s + spent.policy_s) / 60.0;
        let minutes = Spent::of(&folder).map(|it| (100.0 * minutes(it)).round() / 100.0);
        Some(PolicyScore {
            dataset: self.dataset.clone(),
            dataset_digest: dataset.digest,
            config: self.config.clone(),
            evaluation,
            quality: reward.quality,
            minutes,
            machine: processor(),
        })
    }
}

#[cfg(test)]
mod tests {
    use firmware_sim::bridge::Engine;
    use firmware_sim::controller::Numeric;

    use super::*;
    use crate::dataset::fixtures;
    use crate::dataset::minari::{Behaviour, DatasetId, DatasetWriter, Origin};

    fn two(sets: &[&str]) -> Vec<PolicyRun> {
        let one_flight = ["schedule.evaluation_episodes=1"];
        let sets = one_flight.iter().chain(sets);
        let sets: Vec<String> = sets.map(|&set| set.to_owned()).collect();
        runs(&["reach-v3".to_owned()], &[Preset::True], &[0, 1], &sets).unwrap()
    }

    /// A run as it is when it has flown.
    fn finish(out: &Path, run: &PolicyRun, dataset_digest: &str) {
        let dataset = DatasetReference {
            id: "ted/x-v0".to_owned(),
            digest: dataset_digest.to_owned(),
            path: PathBuf::new(),
        };
        let folder = RunFolder::begin(&run.folder(out), &run.config, &dataset).unwrap();
        let reward = RewardReport {
            queries: 0,
            fits: Vec::new(),
            held_out: None,
            preferences_digest: None,
            low: 0.0,
            high: 1.0,
            quality: None,
            confidence: None,
        };
        folder.write_json("reward.json", &reward).unwrap();
        let evaluation = Evaluation {
            task: "reach-v3".to_owned(),
            numeric: Numeric::F32,
            engine: Engine::default(),
            seed: run.config.seed,
            returns: vec![1.5],
            return_mean: 1.5,
            return_sd: 0.0,
            score: Some(0.25),
            success: 1.0,
            faulted: 0,
            faults: Vec::new(),
            dataset_mean: 1.0,
            dataset_max: 6.0,
        };
        folder.write_json(EVALUATION, &evaluation).unwrap();
    }

    fn dataset_in(root: &Path) -> PathBuf {
        let origin = Origin {
            task: "reach-v3".to_owned(),
            recipe: "none".to_owned(),
            seed: 0,
            episodes: 1,
            goal: String::new(),
            reward: String::new(),
            engine: BTreeMap::new(),
        };
        let behaviour = Behaviour {
            part: "all".to_owned(),
            noise_std: 0.0,
            epsilon: 0.0,
            ..Behaviour::default()
        };
        let id = DatasetId::new("ted", "x", 0).unwrap();
        let writer = DatasetWriter::open(root, id, origin, fixtures::SHAPE).unwrap();
        let episode = &fixtures::records(&[9])[0];
        writer.write(0, behaviour, episode).unwrap();
        writer.finish().unwrap()
    }

    fn fill_from(dataset: &Path, out: &Path, runs: &[PolicyRun]) -> Result<(), StudyError> {
        let locate = |_: &str| dataset.to_path_buf();
        let scores = out.join("scores.jsonl");
        fill(out, &scores, runs, None, locate, Audience::Nobody)
    }

    fn written(out: &Path) -> String {
        std::fs::read_to_string(out.join("scores.jsonl")).unwrap_or_default()
    }

    #[test]
    fn the_published_scores_are_written_as_they_are_read() {
        let scores = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/methods.jsonl");
        for line in std::fs::read_to_string(scores).unwrap().lines() {
            let score: PolicyScore = serde_json::from_str(line).unwrap();
            assert_eq!(serde_json::to_string(&score).unwrap(), line);
        }
    }

    #[test]
    fn a_study_with_other_settings_is_refused_where_a_run_was_begun() {
        let out = tempfile::tempdir().unwrap();
        let nowhere = Path::new("/nowhere");
        let short = two(&["algorithm.steps=50"]);
        let begun = short[1].folder(out.path());
        std::fs::create_dir_all(&begun).unwrap();
        std::fs::write(begun.join("config.toml"), short[1].config.to_toml()).unwrap();
        let error = fill_from(nowhere, out.path(), &short).unwrap_err();
        assert!(matches!(error, StudyError::Fleet(_)), "{error}");

        let long = two(&[]);
        let error = fill_from(nowhere, out.path(), &long).unwrap_err();
        let error = error.to_string();
        for part in ["seed-1", "`steps = 50` there", "--out"] {
            assert!(error.contains(part), "{error}");
        }
        // What is in the folder of a run that has its score is of no interest.
        let elsewhere = tempfile::tempdir().unwrap();
        finish(elsewhere.path(), &long[1], "d");
        let score = long[1].read(elsewhere.path()).unwrap();
        cells::append(&out.path().join("scores.jsonl"), &score).unwrap();
        fill_from(nowhere, out.path(), &long[1..]).unwrap();
    }

    #[test]
    fn a_score_outlives_the_folder_of_its_run_and_belongs_to_one_configuration() {
        let out = tempfile::tempdir().unwrap();
        let (nowhere, out) = (Path::new("/nowhere"), out.path());
        let scores = |runs: &[PolicyRun]| scores(out, &out.join("scores.jsonl"), runs).unwrap();
        let runs = two(&[]);
        finish(out, &runs[0], "d");
        // Nothing is missing of the first one, so the dataset is not looked for.
        fill_from(nowhere, out, &runs[..1]).unwrap();
        assert_eq!(written(out).lines().count(), 1);
        finish(out, &runs[1], "d");
        assert_eq!(scores(&runs).len(), 2, "also before it is written down");
        fill_from(nowhere, out, &runs).unwrap();
        let both = written(out);
        assert_eq!(both.lines().count(), 2);
        std::fs::remove_dir_all(out.join("reach-v3")).unwrap();
        fill_from(nowhere, out, &runs).unwrap();
        assert_eq!(written(out), both);

        let found = scores(&runs);
        assert_eq!(found.len(), 2);
        assert_eq!(found[1].config.seed, 1);
        let table = crate::study::table::table(&found);
        let row = table.lines().last().unwrap();
        assert!(row.starts_with("| reach-v3 | true | 2 |"), "{row}");
        assert!(row.contains("0.250, 0.250"), "{row}");
        assert_eq!(scores(&two(&["algorithm.steps=50"])), []);
    }

    #[test]
    fn a_place_where_no_score_can_be_written_is_told_before_anything_is_begun() {
        let out = tempfile::tempdir().unwrap();
        let (out, runs) = (out.path(), two(&[]));
        let scores = Path::new("/proc/no-such-folder/scores.jsonl");
        let locate = |_: &str| PathBuf::from("/nowhere");
        let error = fill(out, scores, &runs, None, locate, Audience::Nobody).unwrap_err();
        assert!(matches!(error, StudyError::Scores(_)), "{error}");
        assert!(error.to_string().contains("cannot write"), "{error}");
    }

    #[test]
    fn what_is_named_twice_is_one_run() {
        let (tasks, presets) = (["a", "b", "a"].map(str::to_owned), [Preset::Bc, Preset::Bc]);
        let runs = runs(&tasks, &presets, &[1, 0], &[]).unwrap();
        let named = runs
            .iter()
            .map(|run| (run.dataset.as_str(), run.config.seed));
        assert!(named.eq([("a", 1), ("b", 1), ("a", 0), ("b", 0)]));
    }

    #[test]
    fn a_flight_of_another_number_of_episodes_is_no_score() {
        let out = tempfile::tempdir().unwrap();
        let runs = two(&["schedule.evaluation_episodes=2"]);
        finish(out.path(), &runs[0], "d");
        assert_eq!(runs[0].read(out.path()), None);
    }

    #[test]
    fn scores_of_another_dataset_of_the_same_name_are_no_company() {
        let out = tempfile::tempdir().unwrap();
        let (nowhere, out) = (Path::new("/nowhere"), out.path());
        let dataset = dataset_in(out);
        let runs = two(&["algorithm.steps=1"]);
        finish(out, &runs[0], "another");
        // Of a run that is to be made, and of one that is finished.
        let to_make = fill_from(&dataset, out, &runs).unwrap_err();
        assert!(!runs[1].folder(out).exists());
        finish(out, &runs[1], "third");
        let finished = fill_from(nowhere, out, &runs).unwrap_err();
        for error in [to_make, finished] {
            let error = error.to_string();
            for part in ["reach-v3", "digest another", "--scores"] {
                assert!(error.contains(part), "{error}");
            }
        }
        assert_eq!(written(out), "");
    }

    #[test]
    fn the_scores_of_the_documents_are_read_and_written_as_they_are() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/methods.jsonl");
        let text = std::fs::read_to_string(&path).unwrap();
        let scores: Vec<PolicyScore> = cells::read(&path).unwrap();
        assert!(!scores.is_empty());
        let lines = scores
            .iter()
            .map(|it| serde_json::to_string(it).unwrap() + "\n");
        assert_eq!(lines.collect::<String>(), text);
    }
}
