//! A line of the file of scores.

use serde::{Deserialize, Serialize};

use super::{Family, Method};
use crate::config::Preset;
use crate::study::run::RunScore;

/// What a run came to, and the first row that shows it. A line repeats outside what a reader without our types looks for:
/// task, preset, seed, number of answers, score and success.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Line", into = "Line")]
pub struct AnswerScore {
    /// The table.
    pub family: Family,
    /// The variant, with the task the row.
    pub variant: String,
    /// The column.
    pub method: Method,
    /// What it came to, and everything that decided it.
    pub run: RunScore,
}

#[derive(PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    family: Family,
    variant: String,
    task: String,
    method: Method,
    preset: Preset,
    seed: u64,
    answers: usize,
    score: Option<f64>,
    success: f64,
    run: RunScore,
}

impl From<AnswerScore> for Line {
    fn from(it: AnswerScore) -> Self {
        Self {
            family: it.family,
            variant: it.variant,
            task: it.run.evaluation.task.clone(),
            method: it.method,
            preset: it.run.config.preset,
            seed: it.run.config.seed,
            answers: it.run.config.answers(),
            score: it.run.evaluation.score,
            success: it.run.evaluation.success,
            run: it.run,
        }
    }
}

impl TryFrom<Line> for AnswerScore {
    type Error = String;

    fn try_from(line: Line) -> Result<Self, String> {
        let score = Self {
            family: line.family,
            variant: line.variant.clone(),
            method: line.method,
            run: line.run.clone(),
        };
        match Line::from(score.clone()) == line {
            true => Ok(score),
            false => Err(
                "task, preset, seed, answers, score or success is not that of its `run`".to_owned(),
            ),
        }
    }
}
