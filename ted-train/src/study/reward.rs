//! How the design of the ten-query reward ensemble changes what it knows about a dataset.
//!
//! Policies cost hours and reward models seconds, so designs are judged by how they order episodes and transitions, over
//! several tasks and seeds. Each cell of the study is appended to a JSONL file as it is measured; a stopped study goes on.

use std::collections::BTreeMap;
use std::fs::File;
use std::path::{Path, PathBuf};

use firmware_sim::interrupt;
use firmware_sim::progress::{Audience, Progress};
use serde::{Deserialize, Serialize};

use crate::config::{Overrides, Preset};
use crate::dataset::Dataset;
use crate::export::ExportError;
use crate::preferences::{Interview, PreferenceLog, ScriptedTeacher};
use crate::reward::oprl::OprlConfig;
use crate::reward::quality::RewardQuality;
use crate::reward::{Labels, LearnError, Material, RewardConfig, RewardLearner};
use crate::rng::Seed;
use crate::train::TrainError;
use firmware_sim::disk::{self, WriteError};

use super::cells::{self, CellsError};

/// The designs that are compared: a name and what it changes of the defaults.
pub const DESIGNS: [(&str, &[&str]); 9] = [
    ("default", &[]),
    ("observation only", &["reward.inputs=observation"]),
    ("raw inputs", &["reward.scaling={kind=\"raw\"}"]),
    (
        "standardised, floor 0.001",
        &["reward.scaling={kind=\"standard\", floor=0.001}"],
    ),
    ("linear output", &["reward.output=linear"]),
    ("hidden 256-256", &["reward.hidden=[256, 256]"]),
    ("50 epochs", &["reward.epochs=50"]),
    ("1000 epochs", &["reward.epochs=1000"]),
    ("learning rate 1e-3", &["reward.learning_rate=1e-3"]),
];

/// One ensemble: what it was and what it knows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// Name of the design.
    pub design: String,
    /// Its resolved configuration.
    pub config: OprlConfig,
    /// The task.
    pub task: String,
    /// The seed.
    pub seed: u64,
    /// Share of held-out pairs ordered as the true returns order them.
    pub held_out: f64,
    /// Agreement with the dataset's own rewards.
    pub quality: Option<RewardQuality>,
}

/// Measures one design on one dataset with one seed.
///
/// # Errors
/// When there are no rewards to answer by, the ensemble cannot be learned, or the preference log not be written.
pub fn measure(
    design: &str,
    config: &OprlConfig,
    dataset: &Dataset,
    seed: u64,
    log: &Path,
) -> Result<Cell, TrainError> {
    let mut teacher = ScriptedTeacher::truthful();
    teacher.check(dataset).map_err(LearnError::from)?;
    let log = PreferenceLog::open(log, dataset).map_err(LearnError::from)?;
    let mut interview = Interview::new(dataset, &mut teacher, log);
    let on = Material {
        dataset,
        seed: Seed::root(seed).child("reward"),
        backend: crate::nn::Backend::Flex,
        audience: Audience::Nobody,
    };
    let answers = config.ask(on, &mut interview)?;
    let learned = config.learn(&answers, on, &mut interview, &mut |_| Ok(()))?;
    let raw = learned
        .model
        .raw_rewards(dataset)
        .map_err(ExportError::from)?;
    let labels = Labels::unit(dataset, raw);
    Ok(Cell {
        design: design.to_owned(),
        config: config.clone(),
        task: dataset.task().unwrap_or("unknown").to_owned(),
        seed,
        held_out: learned.held_out.agreement,
        quality: RewardQuality::measure(dataset, &labels),
    })
}

/// The configuration of a design: the defaults, what the person set, and what the design changes, which wins because its
/// name says so.
///
/// # Errors
/// When a `--set` is not valid for a reward ensemble.
pub fn design_config(
    changes: &[&str],
    sets: &[String],
) -> Result<OprlConfig, crate::config::ConfigError> {
    let all = sets
        .iter()
        .map(String::as_str)
        .chain(changes.iter().copied());
    let overrides = all
        .into_iter()
        .try_fold(Overrides::default(), |overrides, set| overrides.set(set))?;
    overrides.meant_for(&[Preset::OprlI])?;
    match overrides.resolve(Some(Preset::OprlI), None)?.reward {
        RewardConfig::Oprl(config) => Ok(config),
        _ => Err(crate::config::ConfigError::Override {
            argument: "reward.source".to_owned(),
        }),
    }
}

/// The file of a study, with the cells it already holds. No other process writes to its folder meanwhile.
pub struct StudyLog {
    folder: PathBuf,
    _lock: File,
    /// Cells measured so far.
    pub cells: Vec<Cell>,
}

impl StudyLog {
    /// Opens the log of a folder or begins one.
    ///
    /// # Errors
    /// When another process has the folder, the disk fails, or a line is not a cell: nothing is changed then.
    pub fn open(folder: &Path) -> Result<Self, CellsError> {
        disk::create_folder(folder)?;
        let lock = disk::lock(folder)?;
        Ok(Self {
            folder: folder.to_path_buf(),
            _lock: lock,
            cells: cells::read(&folder.join("cells.jsonl"))?,
        })
    }

    fn push(&mut self, cell: Cell) -> Result<(), WriteError> {
        cells::append(&self.folder.join("cells.jsonl"), &cell)?;
        self.cells.push(cell);
        Ok(())
    }

    /// Measures what is missing of designs x seeds on one dataset.
    ///
    /// # Errors
    /// When a measurement fails or is interrupted; what was measured is kept.
    pub fn fill(
        &mut self,
        designs: &[(String, OprlConfig)],
        dataset: &Dataset,
        seeds: &[u64],
        progress: &Progress,
    ) -> Result<(), TrainError> {
        let task = dataset.task().unwrap_or("unknown").to_owned();
        for (design, config) in designs {
            for &seed in seeds {
                if interrupt::requested() {
                    return Err(LearnError::Interrupted.into());
                }
                let known = |c: &Cell| {
                    c.config == *config && c.task == task && c.seed == seed && c.design == *design
                };
                if !self.cells.iter().any(known) {
                    let folder = self
                        .folder
                        .join(&task)
                        .join(design.replace([' ', ','], "-"));
                    disk::create_folder(&folder)?;
                    let log = folder.join(format!("seed-{seed}.jsonl"));
                    // Questions of a half-measured cell are asked again: they depend on nothing else.
                    std::fs::remove_file(&log).or_else(|e| match e.kind() {
                        std::io::ErrorKind::NotFound => Ok(()),
                        _ => Err(WriteError::at(&log, e)),
                    })?;
                    self.push(measure(design, config, dataset, seed, &log)?)?;
                }
                progress.advance(1);
            }
        }
        Ok(())
    }

    /// The table of the docs: mean and standard deviation over seeds, a row for each design and task.
    #[must_use]
    pub fn table(&self, designs: &[(String, OprlConfig)]) -> String {
        let mut rows = vec![
            "| design | task | Spearman | low third | high third | transition Pearson | best 5 % kept | top 10 % lift | held-out pairs |".to_owned(),
            "|---|---|---|---|---|---|---|---|---|".to_owned(),
        ];
        for (design, config) in designs {
            let mut tasks: BTreeMap<&str, Vec<&Cell>> = BTreeMap::new();
            for cell in self
                .cells
                .iter()
                .filter(|c| c.design == *design && c.config == *config)
            {
                tasks.entry(&cell.task).or_default().push(cell);
            }
            for (task, cells) in tasks {
                let column = |values: Vec<f64>| match values.is_empty() {
                    true => "-".to_owned(),
                    false => super::spread(&values, |value| format!("{value:+.2}")),
                };
                let quality = |value: fn(&RewardQuality) -> f64| {
                    let known = cells.iter().filter_map(|cell| cell.quality.as_ref());
                    column(known.map(value).collect())
                };
                let columns = [
                    quality(|it| it.spearman),
                    quality(|it| it.spearman_low_third),
                    quality(|it| it.spearman_high_third),
                    quality(|it| it.transition_pearson),
                    quality(|it| it.best_kept),
                    quality(|it| it.top_decile_lift.unwrap_or(f64::NAN)),
                    column(cells.iter().map(|cell| cell.held_out).collect()),
                ];
                rows.push(format!("| {design} | {task} | {} |", columns.join(" | ")));
            }
        }
        rows.join("\n")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_processes_do_not_measure_into_one_folder() {
        let folder = tempfile::tempdir().unwrap();
        let first = StudyLog::open(folder.path()).unwrap();
        assert!(matches!(
            StudyLog::open(folder.path()),
            Err(CellsError::Disk(WriteError::Busy { .. }))
        ));
        drop(first);
        assert!(StudyLog::open(folder.path()).is_ok());
    }
}
