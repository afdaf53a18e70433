//! What ten answers are worth: the benchmark of `docs/answers.jsonl`, on logs of many kinds, beside what needs no answer, with
//! answers that say nothing and with answers that say the opposite.
//!
//! The plan says which rows there are; a run that several rows show is made once. A table is of the file of scores and trains
//! nothing.

mod line;
mod merge;
mod method;
mod plan;
mod rows;
mod shard;
mod table;
#[cfg(test)]
mod tests;

pub use crate::statistics::Estimate;
pub use line::AnswerScore;
pub use merge::{MergeError, Merged, merge};
pub use method::Method;
pub use plan::{Desk, Planned, plan, to_make};
pub use rows::{Family, Log, Row, rows};
pub use shard::Shard;
pub use table::{Aggregate, Section, markdown, sections};

use std::path::Path;

use super::cells;
use super::fill::{self, Making, StudyError};
use super::run::{RunScore, StudyRun};

/// Trains and flies what has no score yet in this file, nor in `kept`, in the order of the plan; collects datasets that are
/// missing.
///
/// # Errors
/// As [`fill::fill`], and when a file cannot be read.
pub fn fill(
    making: Making<'_>,
    kept: Option<&Path>,
    planned: &[Planned],
) -> Result<(), StudyError> {
    let mut known = Vec::new();
    for path in [Some(making.scores), kept].into_iter().flatten() {
        let lines: Vec<AnswerScore> = cells::read(path)?;
        known.extend(lines.into_iter().map(|line| line.run));
    }
    let known: Vec<RunScore> = known;
    let runs: Vec<StudyRun> = planned.iter().map(|one| one.run.clone()).collect();
    fill::fill(making, &runs, &known, |place, score| {
        cells::append(making.scores, &planned[place].line(score))
    })
}
