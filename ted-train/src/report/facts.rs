//! What a report tells: everything that there is to know about a run, gathered from its folder and its dataset.

use std::path::{Path, PathBuf};

use firmware_sim::progress::Audience;
use serde_json::{Map, Value};

use crate::ask::Channels;
use crate::check::Check;
use crate::config::{Config, Preset};
use crate::dataset::{Dataset, Segment};
use crate::evaluate::Evaluation;
use crate::inspect::RunText;
use crate::preferences::{LogEntry, PreferenceLog};
use crate::quantise::QuantisationReport;
use crate::ranking::ranking;
use crate::run::{DATASET, DatasetReference, EVALUATION, PREFERENCES, QUANTISATION, RunFolder};
use crate::train::{FinishedRun, TrainError};

use super::ReportError;
use super::shot::{Camera, Flown, Shot};
use super::verdict::Verdict;

/// Episodes of the best, and of the worst, that are shown.
const SHOWN: usize = 3;
/// Questions whose clips are shown. More would make the page too large for a browser.
const QUESTIONS: usize = 20;

/// All of it.
pub(super) struct Facts {
    pub verdict: Verdict,
    pub run: RunText,
    pub asked: Vec<Asked>,
    /// A flight like most; none if nobody flew, or nobody can fly it here.
    pub flight: Option<Flown>,
    pub predicted: Option<Predicted>,
    pub curves: Vec<Curve>,
    pub clone: Option<Evaluation>,
    pub integers: Option<QuantisationReport>,
    /// What the logs are like.
    pub check: Check,
    /// Episodes of the dataset.
    pub episodes: usize,
    /// Names of the actions' channels.
    pub actions: Vec<String>,
}

/// A question and what was said to it.
pub(super) struct Asked {
    pub entry: LogEntry,
    /// Both clips; none of a question beyond the first twenty.
    pub shots: Option<[Shot; 2]>,
}

/// What a run predicts of each episode, beside what is true.
pub(super) struct Predicted {
    /// Predicted returns, by episode.
    pub returns_hat: Vec<f32>,
    /// True returns; none where the dataset has no rewards.
    pub returns_true: Option<Vec<f64>>,
    /// The predicted return that an episode needs for the full discount; none where all have the same.
    pub border: Option<f32>,
    /// The best and the worst by prediction.
    pub best: Vec<Shot>,
    pub worst: Vec<Shot>,
}

/// A number over the updates of a phase.
pub(super) struct Curve {
    pub phase: String,
    pub name: String,
    pub points: Vec<(f64, f64)>,
}

impl Facts {
    pub fn gather(
        folder: &RunFolder,
        dataset: &Dataset,
        at: &Path,
        audience: Audience,
    ) -> Result<Self, ReportError> {
        let run = RunText::read(folder)?;
        let channels = Channels::of(dataset);
        let mut camera = Camera::of(dataset, at, audience);
        let clone = clone_of(folder, &run);
        let rewarded = dataset.only_reward().is_none();
        let confidence = run
            .reward
            .as_ref()
            .and_then(|reward| reward.confidence.as_ref());
        let verdict = Verdict::new(
            run.evaluation.as_ref(),
            clone.as_ref(),
            confidence,
            rewarded,
        );
        let held = |name: &str| folder.file(name).is_file();
        let integers = held(QUANTISATION)
            .then(|| folder.read_json(QUANTISATION))
            .transpose()?;
        let asked = match held(PREFERENCES) {
            true => PreferenceLog::read(folder.file(PREFERENCES), dataset)?,
            false => Vec::new(),
        };
        let asked = asked.into_iter().enumerate().map(|(number, entry)| {
            let segments = (number < QUESTIONS).then_some(entry.question.query.segments);
            Asked {
                shots: segments.map(|both| both.map(|it| camera.shoot(it))),
                entry,
            }
        });
        let asked = asked.collect();
        let flown = run.evaluation.as_ref();
        let artefact = folder.artefact_path();
        Ok(Self {
            flight: flown.and_then(|flown| camera.shoot_flight(flown, &artefact, dataset)),
            asked,
            predicted: predicted(folder, dataset, &mut camera, &run, audience)?,
            curves: curves(&folder.file("metrics.jsonl")),
            check: Check::of(dataset, at),
            episodes: dataset.episodes().len(),
            actions: channels.actions,
            verdict,
            run,
            clone,
            integers,
        })
    }
}

/// What the run's reward says of the logs; none where no reward was learned, or the run has not ended.
fn predicted(
    folder: &RunFolder,
    dataset: &Dataset,
    camera: &mut Camera<'_>,
    run: &RunText,
    audience: Audience,
) -> Result<Option<Predicted>, ReportError> {
    if run.config.reward.is_none() || run.step < run.steps {
        return Ok(None);
    }
    let finished = match FinishedRun::read(folder, dataset, audience) {
        Err(TrainError::NotForControllers { .. }) => return Ok(None),
        finished => finished?,
    };
    let returns_hat = finished.labels().returns_hat.clone();
    let border = run.config.discount.lookup(&returns_hat)?;
    let order = ranking(
        &returns_hat
            .iter()
            .copied()
            .map(f64::from)
            .collect::<Vec<_>>(),
    );
    let mut shot = |&episode: &usize| {
        let length = dataset.episodes()[episode].len;
        let whole = (u32::try_from(episode).ok()).zip(u32::try_from(length).ok());
        let segment =
            whole.and_then(|(episode, length)| Segment::new(dataset, episode, 0, length).ok());
        segment.map(|segment| camera.shoot(segment))
    };
    let truth = dataset.only_reward().is_none();
    Ok(Some(Predicted {
        best: order.iter().take(SHOWN).filter_map(&mut shot).collect(),
        worst: order.iter().rev().take(SHOWN).filter_map(shot).collect(),
        returns_true: truth.then(|| dataset.episodes().iter().map(|it| it.return_true).collect()),
        border: border.map(|border| border.threshold().return_hat),
        returns_hat,
    }))
}

/// How a clone of the same logs flew, if there is one where `ted train`, a study or `ted quickstart` puts it: beside the run, or
/// beside the folder of its preset. Of several, that of the same seed, and then of as many updates.
fn clone_of(folder: &RunFolder, run: &RunText) -> Option<Evaluation> {
    // A short relative path has no parent to look in.
    let own = folder.path().canonicalize().ok()?;
    let parent = own.parent()?;
    let beside = entries(parent);
    let presets = parent.parent().map(entries).unwrap_or_default();
    let under = presets
        .iter()
        .filter(|path| named_bc(path))
        .flat_map(|path| entries(path));
    let clones = beside
        .into_iter()
        .filter(|path| named_bc(path))
        .chain(under)
        .filter(|path| *path != own)
        .filter_map(|path| clone_in(path, run));
    clones.min_by(|a, b| a.0.cmp(&b.0)).map(|(_, flown)| flown)
}

/// Whether this is the folder of clones or of one.
fn named_bc(path: &Path) -> bool {
    let name = path.file_name().and_then(|name| name.to_str());
    name.is_some_and(|name| name == "bc" || name.starts_with("bc-") || name == "clone")
}

fn entries(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    entries.map(|entry| entry.path()).collect()
}

/// How far the clone in this folder is from the run (another seed, another number of updates, its path), and how it flew.
fn clone_in(path: PathBuf, run: &RunText) -> Option<((bool, bool, PathBuf), Evaluation)> {
    let folder = RunFolder::open(&path).ok()?;
    let config = Config::read(&folder.config_path()).ok()?;
    let dataset: DatasetReference = folder.read_json(DATASET).ok()?;
    let flown: Evaluation = folder.read_json(EVALUATION).ok()?;
    let ours = run.evaluation.as_ref()?;
    let same = dataset.digest == run.dataset.digest
        && config.preset == Preset::Bc
        && flown.task == ours.task;
    let far = (
        config.seed != run.config.seed,
        config.algorithm.steps() != run.steps,
        path,
    );
    same.then_some((far, flown))
}

/// Every number that the run wrote down while it learned.
fn curves(log: &Path) -> Vec<Curve> {
    let text = std::fs::read_to_string(log).unwrap_or_default();
    let mut curves: Vec<Curve> = Vec::new();
    for row in text
        .lines()
        .filter_map(|line| serde_json::from_str::<Map<String, Value>>(line).ok())
    {
        let phase = row.get("phase").and_then(Value::as_str).unwrap_or_default();
        let Some(step) = row.get("step").and_then(Value::as_f64) else {
            continue;
        };
        for (name, value) in row.iter().filter(|(name, _)| *name != "step") {
            let Some(value) = value.as_f64() else {
                continue;
            };
            let known = (curves.iter_mut()).find(|it| it.phase == phase && it.name == *name);
            match known {
                Some(curve) => curve.points.push((step, value)),
                None => curves.push(Curve {
                    phase: phase.to_owned(),
                    name: name.clone(),
                    points: vec![(step, value)],
                }),
            }
        }
    }
    curves
}
