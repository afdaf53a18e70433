//! Scores of whole runs: every combination of task, preset and seed, trained and flown, in one resumable table.
//!
//! The runs are a fleet. One that is finished is not done again.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use firmware_sim::progress::Audience;
use serde::Serialize;

use crate::config::{ConfigError, Overrides, Preset};
use crate::evaluate::Evaluation;
use crate::fleet::{self, Datasets, FleetError, Lane};
use crate::reward::quality::RewardQuality;
use crate::run::{EVALUATION, RunError, RunFolder, Spent};
use crate::train::RewardReport;

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
    /// How long it took, if somebody looked at the clock.
    pub spent: Option<Spent>,
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
    /// Runs that failed; the others were finished.
    #[error(transparent)]
    Fleet(#[from] FleetError),
}

/// Refuses changes that cannot be made, and a place where one of these runs was begun with others: its score would stand
/// in a row that it does not belong to.
///
/// # Errors
/// Names the change, or the folder and what differs.
pub fn check(out: &Path, runs: &[PolicyRun], sets: &[String]) -> Result<(), StudyError> {
    let changes = changes(sets)?;
    let presets: Vec<_> = runs.iter().map(|run| run.preset).collect();
    changes.meant_for(&presets)?;
    for run in runs {
        let config = changes.resolve(Some(run.preset), Some(run.seed))?;
        RunFolder::holds(&run_path(out, run), &config)?;
    }
    Ok(())
}

/// Trains and flies what is missing, as a fleet; `locate` finds the datasets.
///
/// # Errors
/// The first failure of a run; the others are finished first. [`check`] tells beforehand what would make all of them fail.
pub fn fill(
    out: &Path,
    runs: &[PolicyRun],
    sets: &[String],
    jobs: Option<NonZeroUsize>,
    locate: impl Fn(&str) -> PathBuf,
    audience: Audience,
) -> Result<(), StudyError> {
    let changes = changes(sets)?;
    let mut lanes = Vec::new();
    for run in runs {
        lanes.push(Lane {
            dataset: locate(&run.dataset),
            config: changes.resolve(Some(run.preset), Some(run.seed))?,
            folder: run_path(out, run),
            answers: None,
            siblings: Vec::new(),
        });
    }
    fleet::introduce(&mut lanes);
    lanes.retain(|lane| !lane.folder.join(EVALUATION).exists());
    let ends = fleet::run(&lanes, &Datasets::default(), jobs, audience);
    match fleet::first_failure(&lanes, ends) {
        None => Ok(()),
        Some(error) => Err(error.into()),
    }
}

fn changes(sets: &[String]) -> Result<Overrides, ConfigError> {
    sets.iter()
        .try_fold(Overrides::default(), |all, set| all.set(set))
}

fn run_path(out: &Path, run: &PolicyRun) -> PathBuf {
    out.join(run.dataset.replace('/', "_"))
        .join(run.preset.name())
        .join(format!("seed-{}", run.seed))
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
            spent: Spent::of(&folder),
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
        "| task | preset | seeds | return | normalised score | each seed | success | the paper's score | minutes | Spearman | low third | high third | transition Pearson |".to_owned(),
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|".to_owned(),
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
        let quality = |value: fn(&RewardQuality) -> f64| {
            if group.iter().any(|s| s.reward.quality.is_none()) {
                return "-".to_owned();
            }
            column(2, &|s| s.reward.quality.as_ref().map_or(f64::NAN, value))
        };
        rows.push(format!(
            "| {dataset} | {preset} | {seeds} | {ret} | {score} | {each} | {success} | {paper} | {minutes} | {rho} | {low} | {high} | {transition} |",
            seeds = group.len(),
            ret = column(0, &|s| s.evaluation.return_mean),
            score = column(3, &|s| s.evaluation.score.unwrap_or(f64::NAN)),
            each = each.join(", "),
            success = column(2, &|s| s.evaluation.success),
            paper = paper_score(group[0]),
            minutes = minutes(&group),
            rho = quality(|it| it.spearman),
            low = quality(|it| it.spearman_low_third),
            high = quality(|it| it.spearman_high_third),
            transition = quality(|it| it.transition_pearson),
        ));
    }
    rows.join("\n")
}

fn paper_score(of: &PolicyScore) -> String {
    let preset = Preset::try_from(of.preset.clone()).ok();
    let known = preset.and_then(|preset| super::paper::score(&of.evaluation.task, preset));
    known.map_or_else(
        || "-".to_owned(),
        |[mean, spread]| format!("{mean:.2} ± {spread:.2}"),
    )
}

/// Mean wall time of those whose time is known, that of a reward that was taken from another run included.
fn minutes(group: &[&PolicyScore]) -> String {
    let minutes = |spent: &Spent| (spent.reward_s + spent.policy_s) / 60.0;
    let known: Vec<f64> = group
        .iter()
        .filter_map(|s| s.spent.as_ref().map(minutes))
        .collect();
    match known.len() {
        0 => "-".to_owned(),
        count => format!("{:.1}", known.iter().sum::<f64>() / count as f64),
    }
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
        let short = ["algorithm.steps=50".to_owned()];
        assert!(check(out.path(), &runs, &short).is_ok(), "nothing is there");

        let mut config = Preset::True.config();
        config.seed = 1;
        config.algorithm.set_steps(50);
        let begun = run_path(out.path(), &run(1));
        std::fs::create_dir_all(&begun).unwrap();
        std::fs::write(begun.join("config.toml"), config.to_toml()).unwrap();
        assert!(check(out.path(), &runs, &short).is_ok());
        let error = check(out.path(), &runs, &[]).unwrap_err().to_string();
        for part in ["seed-1", "`steps = 50` there", "--out"] {
            assert!(error.contains(part), "{error}");
        }
        assert!(check(out.path(), &runs[..1], &[]).is_ok());
    }
}
