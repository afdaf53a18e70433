//! What boards say of a flight, beside what any controller's flight is reported by.

use std::fmt::{self, Display};

use serde::Serialize;

use crate::qemu::{Fleet, instructions};
use crate::rollout::{DeviceLink, DeviceSummary, Work};

/// The boards' part of a report.
#[derive(Debug, Serialize)]
pub struct DeviceReport {
    /// The board.
    pub board: String,
    /// The emulator and its version.
    pub emulator: String,
    /// The link to it.
    pub link: String,
    /// What ticks took.
    pub tick: Instructions,
    /// What scoring them took.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scoring: Option<Instructions>,
    /// The most stack that was ever in use, in bytes.
    pub stack_high_water: u32,
    /// What went wrong on the link.
    pub link_errors: LinkErrors,
    /// What the boards think of the episodes, in the order of the flight; empty if the artefact cannot score.
    pub scores: Vec<Score>,
}

/// Instructions of the emulated processor.
#[derive(Debug, Serialize)]
pub struct Instructions {
    /// On average.
    pub mean: f64,
    /// At most.
    pub max: f64,
}

/// What went wrong on a link.
#[derive(Debug, Serialize)]
pub struct LinkErrors {
    retries: u64,
    damaged: u64,
    repeated: u64,
    lost: u64,
}

/// What a board thinks of an episode.
#[derive(Debug, Serialize)]
pub struct Score {
    return_hat: f32,
    top_k: bool,
}

impl DeviceReport {
    /// What these boards say.
    pub fn of(fleet: &Fleet, summary: &DeviceSummary) -> Self {
        let counted = |work: &Work| Instructions {
            mean: instructions(work.mean(), summary.work_hz),
            max: instructions(f64::from(work.max), summary.work_hz),
        };
        let DeviceLink {
            retries,
            damaged,
            repeated,
            lost,
        } = summary.link;
        let scores = summary.scores.iter().map(|score| Score {
            return_hat: score.return_hat,
            top_k: score.top_k,
        });
        Self {
            board: fleet.board().to_string(),
            emulator: format!("QEMU {}", fleet.emulator().version()),
            link: fleet.link().to_string(),
            tick: counted(&summary.work),
            scoring: (summary.scoring.times > 0).then(|| counted(&summary.scoring)),
            stack_high_water: summary.stack_high_water,
            link_errors: LinkErrors {
                retries,
                damaged,
                repeated,
                lost,
            },
            scores: scores.collect(),
        }
    }
}

impl Display for DeviceReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "board       {} in {}, link {}",
            self.board, self.emulator, self.link
        )?;
        let Instructions { mean, max } = &self.tick;
        writeln!(
            f,
            "work        {mean:.0} instructions a tick, at most {max:.0}"
        )?;
        if let Some(Instructions { mean, max }) = &self.scoring {
            writeln!(
                f,
                "scoring     {mean:.0} instructions a tick, at most {max:.0}"
            )?;
        }
        writeln!(f, "stack       {} bytes at most", self.stack_high_water)?;
        let LinkErrors {
            retries,
            damaged,
            repeated,
            lost,
        } = &self.link_errors;
        writeln!(
            f,
            "link        {retries} asked again, {damaged} damaged, {repeated} repeated, {lost} lost"
        )?;
        if !self.scores.is_empty() {
            let flown = self.scores.len();
            let sum: f64 = self.scores.iter().map(|it| f64::from(it.return_hat)).sum();
            let top_k = self.scores.iter().filter(|it| it.top_k).count();
            writeln!(
                f,
                "predicted   return {:.2} on average; {top_k} of {flown} episodes in the top k %",
                sum / flown as f64
            )?;
        }
        Ok(())
    }
}
