//! The plan: every run that the rows need, once, in the order in which they are best made.

use std::collections::HashMap;
use std::path::Path;

use super::{AnswerScore, Family, Method, rows};
use crate::config::Overrides;
use crate::study::fill::StudyError;
use crate::study::run::{RunScore, StudyRun};

/// Flights of every run: the same for all, or their scores would differ in how sure they are.
const FLIGHTS: &str = "schedule.evaluation_episodes=20";

/// Where the study is made, and what a person changes about all of it.
#[derive(Clone, Copy, Debug)]
pub struct Desk<'a> {
    /// The folder of the datasets.
    pub datasets: &'a Path,
    /// The folder of the runs.
    pub out: &'a Path,
    /// Changes of every run, as `--set` takes them.
    pub sets: &'a [String],
}

/// A run in its place in a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Planned {
    /// The table.
    pub family: Family,
    /// The variant, with the task the row.
    pub variant: &'static str,
    /// The task.
    pub task: &'static str,
    /// The column.
    pub method: Method,
    /// The run.
    pub run: StudyRun,
    /// The first table and variant of the whole plan that show this run, by which its score is called.
    owner: (Family, &'static str),
}

/// What the tables of these families show of these methods, row by row. A run that several rows show is in each of them.
///
/// # Errors
/// Names a change that cannot be made.
pub fn plan(
    families: &[Family],
    methods: &[Method],
    desk: Desk<'_>,
) -> Result<Vec<Planned>, StudyError> {
    let changes = Overrides::default().set(FLIGHTS)?;
    let of_person = desk
        .sets
        .iter()
        .try_fold(Overrides::default(), |all, set| all.set(set))?;
    let presets: Vec<_> = methods.iter().map(|method| method.preset()).collect();
    of_person.meant_for(&presets)?;
    let mut owners = HashMap::new();
    let mut planned = Vec::new();
    for row in rows() {
        let collect = row.log.collect(desk.datasets);
        let dataset = collect.dataset_id()?.to_string();
        let place = collect.folder()?;
        for &(method, seeds) in &row.methods {
            let sets = method.sets().iter().chain(row.sets).copied();
            let sets = sets.chain(desk.sets.iter().map(String::as_str));
            let changes = sets
                .clone()
                .try_fold(changes.clone(), |all, set| all.set(set))?;
            for seed in 0..seeds {
                let key = (dataset.clone(), method, row.sets, seed);
                let owner = *owners.entry(key).or_insert((row.family, row.variant));
                if !families.contains(&row.family) || !methods.contains(&method) {
                    continue;
                }
                let folder = desk.out.join(owner.0.name()).join(slug(owner.1));
                let folder = folder.join(row.log.task).join(slug(method.name()));
                planned.push(Planned {
                    family: row.family,
                    variant: row.variant,
                    task: row.log.task,
                    method,
                    run: StudyRun {
                        dataset: dataset.clone(),
                        place: place.clone(),
                        collect: Some(collect.clone()),
                        config: changes.resolve(Some(method.preset()), Some(seed))?,
                        folder: folder.join(format!("seed-{seed}")),
                    },
                    owner,
                });
            }
        }
    }
    Ok(planned)
}

/// Each run of a plan once: what is cheap first and then what learns values, each seed by seed and dataset by dataset. So an
/// unfinished study has something of every row, and a dataset that was read is used again while it is in memory.
#[must_use]
pub fn to_make(planned: &[Planned]) -> Vec<Planned> {
    let mut datasets: HashMap<&str, usize> = HashMap::new();
    let mut runs: Vec<Planned> = Vec::new();
    for one in planned {
        let next = datasets.len();
        datasets.entry(&one.run.dataset).or_insert(next);
        if !runs.iter().any(|other| other.run == one.run) {
            runs.push(one.clone());
        }
    }
    runs.sort_by_key(|one| {
        let dataset = datasets[one.run.dataset.as_str()];
        (one.method.is_slow(), one.run.config.seed, dataset)
    });
    runs
}

impl Planned {
    /// The line of its score.
    #[must_use]
    pub fn line(&self, score: RunScore) -> AnswerScore {
        let (family, variant) = self.owner;
        AnswerScore {
            family,
            variant: variant.to_owned(),
            method: self.method,
            run: score,
        }
    }

    /// Its score among these.
    #[must_use]
    pub fn score<'s>(&self, lines: &'s [AnswerScore]) -> Option<&'s RunScore> {
        let mut scores = lines.iter().map(|line| &line.run);
        scores.find(|score| self.run.came_to(score))
    }
}

/// Words as a folder's name.
fn slug(words: &str) -> String {
    let words = words.replace([',', '\''], "");
    words.replace(' ', "-")
}
