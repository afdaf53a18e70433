//! Joins files of scores: of the parts of a study, of several machines, and of `ted study policies`, whose runs the plan may know.

use std::path::{Path, PathBuf};

use firmware_sim::disk;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::Value;

use super::plan::{Desk, Planned, plan};
use super::{AnswerScore, Family, Method};
use crate::collect::NAMESPACE;
use crate::config::Preset;
use crate::study::cells::{self, CellsError};
use crate::study::fill::{Digests, StudyError};
use crate::study::run::RunScore;

/// Why files were not joined; none of them was touched.
#[derive(Debug, thiserror::Error)]
pub enum MergeError {
    /// A file, or data that does not go together.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// The same run, and it came to something else.
    #[error(
        "the same run ({run}) came to {} in {first} and to {} in {second}: take one of the lines out, or make the run again",
        .scores[0], .scores[1]
    )]
    Contradiction {
        /// What and on which logs.
        run: String,
        /// The file that was read first.
        first: PathBuf,
        /// The other one.
        second: PathBuf,
        /// Mean return in each.
        scores: [f64; 2],
    },
}

impl From<CellsError> for MergeError {
    fn from(error: CellsError) -> Self {
        Self::Study(error.into())
    }
}

/// What came of joining.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Merged {
    /// Lines of the file now.
    pub lines: usize,
    /// Lines that were there twice.
    pub doubles: usize,
    /// Scores of `ted study policies` whose runs are none of this study.
    pub foreign: usize,
}

/// Joins the lines of `files`, and those of `into` if there is such a file, into `into`, ordered by
/// family, variant, dataset, method and seed.
///
/// # Errors
/// When a file cannot be read or written, and when two lines contradict each other.
pub fn merge(files: &[PathBuf], into: &Path) -> Result<Merged, MergeError> {
    let mut kept: Vec<(AnswerScore, &Path)> = Vec::new();
    let (mut doubles, mut foreign) = (0, 0);
    let (digests, mut plans) = (Digests::new(into), Plans::default());
    for file in [into].into_iter().chain(files.iter().map(PathBuf::as_path)) {
        // A misspelt name would look like a file without a line.
        if file != into {
            std::fs::metadata(file).map_err(|source| CellsError::Io {
                path: file.to_path_buf(),
                source,
            })?;
        }
        for line in cells::read::<Line>(file)? {
            let line = match line {
                Line::Ours(line) => Some(*line),
                Line::OfPolicies(score) => plans.line(*score)?,
            };
            let Some(line) = line else {
                foreign += 1;
                continue;
            };
            let run = &line.run;
            digests.agree(&run.dataset, &run.dataset_digest, Some(&run.machine))?;
            let same = |(other, _): &&(AnswerScore, &Path)| {
                other.run.dataset == run.dataset && other.run.config == run.config
            };
            match kept.iter().find(same) {
                None => kept.push((line, file)),
                Some((other, _)) if other.run.evaluation == run.evaluation => doubles += 1,
                Some((other, first)) => {
                    let [one, two] = [other, &line].map(|it| it.run.evaluation.return_mean);
                    return Err(MergeError::Contradiction {
                        run: format!(
                            "{} on {}, seed {}",
                            line.method.name(),
                            run.dataset,
                            run.config.seed
                        ),
                        first: first.to_path_buf(),
                        second: file.to_path_buf(),
                        scores: [one, two],
                    });
                }
            }
        }
    }
    let mut lines: Vec<AnswerScore> = kept.into_iter().map(|(line, _)| line).collect();
    lines.sort_by(|one, other| key(one).cmp(&key(other)));
    let text: String = lines.iter().map(cells::line).collect();
    disk::replace(into, text.as_bytes()).map_err(StudyError::from)?;
    Ok(Merged {
        lines: lines.len(),
        doubles,
        foreign,
    })
}

/// A line of either file of scores.
enum Line {
    Ours(Box<AnswerScore>),
    OfPolicies(Box<RunScore>),
}

impl<'de> Deserialize<'de> for Line {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let value = Value::deserialize(from)?;
        let line = match value.get("family") {
            Some(_) => serde_json::from_value(value).map(Self::Ours),
            None => serde_json::from_value(value).map(Self::OfPolicies),
        };
        line.map_err(D::Error::custom)
    }
}

/// What the plan has of a preset, once somebody wanted to know.
#[derive(Default)]
struct Plans(Vec<(Preset, Vec<Planned>)>);

impl Plans {
    /// The line of a score of `ted study policies`, if its run is one of the plan. There a dataset may be called by its task.
    fn line(&mut self, mut score: RunScore) -> Result<Option<AnswerScore>, StudyError> {
        let preset = score.config.preset;
        let known = self.0.iter().position(|(name, _)| *name == preset);
        let at = match known {
            Some(at) => at,
            None => {
                self.0.push((preset, planned(preset)?));
                self.0.len() - 1
            }
        };
        let full = format!("{NAMESPACE}/{}-paper-s0-v0", score.dataset);
        let is_it = |one: &&Planned| {
            let dataset = &one.run.dataset;
            (*dataset == score.dataset || *dataset == full) && one.run.config == score.config
        };
        let Some(one) = self.0[at].1.iter().find(is_it) else {
            return Ok(None);
        };
        score.dataset.clone_from(&one.run.dataset);
        Ok(Some(one.line(score)))
    }
}

/// All runs of the plan that start from a preset; where they would be made is of no interest.
fn planned(preset: Preset) -> Result<Vec<Planned>, StudyError> {
    let nowhere = Path::new("");
    let desk = Desk {
        datasets: nowhere,
        out: nowhere,
        sets: &[],
    };
    let mut methods = Method::ALL.to_vec();
    methods.retain(|method| method.preset() == preset);
    plan(&Family::ALL, &methods, desk)
}

fn key(line: &AnswerScore) -> (Family, &str, &str, Method, u64) {
    let AnswerScore {
        family,
        variant,
        method,
        run,
    } = line;
    (*family, variant, &run.dataset, *method, run.config.seed)
}
