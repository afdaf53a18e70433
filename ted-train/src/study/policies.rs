//! Scores of whole runs: every combination of task, preset and seed, trained and flown, in one resumable table.
//!
//! Each run is a `ted train` process of its own with one thread, as many side by side as there are cores: seeds are
//! independent, so that is faster than giving one run all cores. A run that is finished is not done again.

use std::collections::BTreeMap;
use std::fs::File;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::thread;
use std::time::Duration;

use firmware_sim::interrupt;
use firmware_sim::progress::Progress;
use serde::Serialize;

use crate::config::{Overrides, Preset};
use crate::evaluate::Evaluation;
use crate::run::{EVALUATION, RunError, RunFolder};
use crate::train::RewardReport;
use firmware_sim::disk::{self, WriteError};

/// Between two looks at a run that is under way.
const WATCH_PERIOD: Duration = Duration::from_millis(200);

/// One run of the study.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PolicyRun {
    /// A dataset as `ted train` takes it.
    pub dataset: String,
    /// The composition.
    pub preset: Preset,
    /// The seed.
    pub seed: u64,
}

/// What a finished run came to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PolicyScore {
    /// The dataset as it was asked for.
    pub dataset: String,
    /// Name of the composition.
    pub preset: String,
    /// The seed.
    pub seed: u64,
    /// How it flew.
    pub evaluation: Evaluation,
    /// What its rewards were worth.
    pub reward: RewardReport,
}

/// Why a study of policies stopped.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// A configuration that cannot be used.
    #[error(transparent)]
    Config(#[from] crate::config::ConfigError),
    /// A run's folder that holds another one.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The disk.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A run that could not be started.
    #[error("cannot start `ted train`: {0}")]
    Start(std::io::Error),
    /// Runs that failed; the others were finished.
    #[error("{count} of the runs failed; of the first one, {first}")]
    Failed {
        /// How many.
        count: usize,
        /// Why the first one did, or where it says so.
        first: String,
    },
    /// Somebody asked to stop.
    #[error("stopped; the same command goes on from there")]
    Interrupted,
}

/// Refuses changes that cannot be made, and a place where one of these runs was begun with others: its score would stand
/// in a row that it does not belong to.
///
/// # Errors
/// Names the change, or the folder and what differs.
pub fn check(out: &Path, runs: &[PolicyRun], sets: &[String]) -> Result<(), StudyError> {
    let changes = sets
        .iter()
        .try_fold(Overrides::default(), |all, set| all.set(set))?;
    for run in runs {
        let config = changes.resolve(Some(run.preset), Some(run.seed))?;
        RunFolder::holds(&run_path(out, run), &config)?;
    }
    Ok(())
}

/// Trains and flies what is missing, `jobs` runs at a time.
///
/// # Errors
/// When a run fails; the others are finished first. [`check`] tells beforehand what would make all of them fail.
pub fn fill(
    out: &Path,
    runs: &[PolicyRun],
    sets: &[String],
    jobs: usize,
    progress: &Progress,
) -> Result<(), StudyError> {
    disk::create_folder(out)?;
    let queue = Mutex::new(runs.iter());
    let failures = Mutex::new(Vec::new());
    let program = std::env::current_exe().map_err(StudyError::Start)?;
    thread::scope(|scope| {
        for _ in 0..jobs.clamp(1, runs.len().max(1)) {
            scope.spawn(|| {
                while !interrupt::requested() {
                    let Some(run) = queue.lock().ok().and_then(|mut queue| queue.next()) else {
                        break;
                    };
                    match one(&program, out, run, sets) {
                        Ok(true) => progress.advance(1),
                        Ok(false) => {
                            let log = log_path(out, run);
                            push(
                                &failures,
                                format!("the last words are in {}", log.display()),
                            );
                        }
                        Err(error) => push(&failures, error.to_string()),
                    }
                }
            });
        }
    });
    if interrupt::requested() {
        return Err(StudyError::Interrupted);
    }
    let failures = failures.into_inner().unwrap_or_default();
    match failures.first() {
        None => Ok(()),
        Some(first) => Err(StudyError::Failed {
            count: failures.len(),
            first: first.clone(),
        }),
    }
}

fn push(failures: &Mutex<Vec<String>>, failure: String) {
    if let Ok(mut failures) = failures.lock() {
        failures.push(failure);
    }
}

/// Runs `ted train` unless its evaluation is there; true when it is there then.
fn one(program: &Path, out: &Path, run: &PolicyRun, sets: &[String]) -> std::io::Result<bool> {
    let folder = run_path(out, run);
    if folder.join(EVALUATION).exists() {
        return Ok(true);
    }
    std::fs::create_dir_all(&folder)?;
    let log = File::create(log_path(out, run))?;
    let mut child = Command::new(program)
        .arg("train")
        .arg(&run.dataset)
        .args([
            "--preset",
            run.preset.name(),
            "--workers",
            "1",
            "--seed",
            &run.seed.to_string(),
        ])
        .arg("--out")
        .arg(&folder)
        .args(sets.iter().flat_map(|set| ["--set", set]))
        .env("RAYON_NUM_THREADS", "1")
        .stdin(Stdio::null())
        .stdout(log.try_clone()?)
        .stderr(log)
        // A Ctrl-C at the terminal reaches this process alone, which passes it on, or the child would count it twice.
        .process_group(0)
        .spawn()?;
    let mut asked = false;
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(status.success());
        }
        if interrupt::requested() && !asked {
            interrupt::pass_on(&child)?;
            asked = true;
        }
        thread::park_timeout(WATCH_PERIOD);
    }
}

fn run_path(out: &Path, run: &PolicyRun) -> PathBuf {
    out.join(run.dataset.replace('/', "_"))
        .join(run.preset.name())
        .join(format!("seed-{}", run.seed))
}

fn log_path(out: &Path, run: &PolicyRun) -> PathBuf {
    run_path(out, run).join("train.log")
}

/// The scores of the finished runs.
#[must_use]
pub fn scores(out: &Path, runs: &[PolicyRun]) -> Vec<PolicyScore> {
    let read = |run: &PolicyRun| {
        let folder = RunFolder::open(&run_path(out, run)).ok()?;
        Some(PolicyScore {
            dataset: run.dataset.clone(),
            preset: run.preset.name().to_owned(),
            seed: run.seed,
            evaluation: folder.read_json(EVALUATION).ok()?,
            reward: folder.read_json("reward.json").ok()?,
        })
    };
    runs.iter().filter_map(read).collect()
}

/// A Markdown table: a row for each task and preset, mean and sample standard deviation over seeds.
#[must_use]
pub fn table(scores: &[PolicyScore]) -> String {
    let mut groups: BTreeMap<(&str, &str), Vec<&PolicyScore>> = BTreeMap::new();
    for score in scores {
        groups
            .entry((&score.dataset, &score.preset))
            .or_default()
            .push(score);
    }
    let mut rows = vec![
        "| task | preset | seeds | return | normalised score | each seed | success | Spearman | low third | high third | transition Pearson |".to_owned(),
        "|---|---|---|---|---|---|---|---|---|---|---|".to_owned(),
    ];
    for ((dataset, preset), group) in groups {
        let column = |digits: usize, value: &dyn Fn(&PolicyScore) -> f64| {
            let values: Vec<_> = group.iter().map(|s| value(s)).collect();
            super::spread(&values, |value| format!("{value:.digits$}"))
        };
        let each: Vec<String> = group
            .iter()
            .map(|s| format!("{:.3}", s.evaluation.score.unwrap_or(f64::NAN)))
            .collect();
        let quality = |value: fn(&PolicyScore) -> f64| column(2, &value);
        rows.push(format!(
            "| {dataset} | {preset} | {seeds} | {ret} | {score} | {each} | {success} | {rho} | {low} | {high} | {transition} |",
            seeds = group.len(),
            ret = column(0, &|s| s.evaluation.return_mean),
            score = column(3, &|s| s.evaluation.score.unwrap_or(f64::NAN)),
            each = each.join(", "),
            success = column(2, &|s| s.evaluation.success),
            rho = quality(|s| s.reward.quality.spearman),
            low = quality(|s| s.reward.quality.spearman_low_third),
            high = quality(|s| s.reward.quality.spearman_high_third),
            transition = quality(|s| s.reward.quality.transition_pearson),
        ));
    }
    rows.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_study_with_other_settings_is_refused_where_a_run_was_begun() {
        let out = tempfile::tempdir().unwrap();
        let run = |seed| PolicyRun {
            dataset: "reach-v3".to_owned(),
            preset: Preset::True,
            seed,
        };
        let runs = [run(0), run(1)];
        let short = ["iql.steps=50".to_owned()];
        assert!(check(out.path(), &runs, &short).is_ok(), "nothing is there");

        let mut config = Preset::True.config();
        (config.seed, config.iql.steps) = (1, 50);
        let begun = run_path(out.path(), &run(1));
        disk::create_folder(&begun).unwrap();
        std::fs::write(begun.join("config.toml"), config.to_toml()).unwrap();
        assert!(check(out.path(), &runs, &short).is_ok());
        let error = check(out.path(), &runs, &[]).unwrap_err().to_string();
        for part in ["seed-1", "`steps = 50` there", "--out"] {
            assert!(error.contains(part), "{error}");
        }
        assert!(check(out.path(), &runs[..1], &[]).is_ok());
    }
}
