//! What boards say of a flight, beside what any controller's flight is reported by.

use std::fmt::{self, Display};

use serde::Serialize;

use super::boards::Boards;
use crate::qemu::instructions;
use crate::rollout::{DeviceLink, DeviceSummary, Work};

/// The boards' part of a report.
#[derive(Debug, Serialize)]
pub struct DeviceReport {
    /// What the board calls itself.
    pub board: String,
    /// The emulator and its version; none for a board of one's own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub emulator: Option<String>,
    /// The link to it.
    pub link: String,
    /// What `tick` and `scoring` are counted in.
    pub unit: Unit,
    /// What ticks took.
    pub tick: Taken,
    /// What scoring them took.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scoring: Option<Taken>,
    /// The most stack that was ever in use, in bytes; 0 if the board does not know.
    pub stack_high_water: u32,
    /// What went wrong on the link.
    pub link_errors: LinkErrors,
    /// What the boards think of the episodes, in the order of the flight; empty if the artefact cannot score.
    pub scores: Vec<Score>,
}

/// What a board's work is counted in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Unit {
    /// Instructions of the emulated processor, which its clock counts.
    Instructions,
    /// Microseconds, by the board's counter.
    Microseconds,
    /// Ticks of the board's counter, which does not say how long they are.
    CounterTicks,
}

/// What something took, in a [`Unit`].
#[derive(Debug, Serialize)]
pub struct Taken {
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
    pub fn of(boards: &Boards, summary: &DeviceSummary) -> Self {
        let unit = match boards {
            Boards::Emulated(_) => Unit::Instructions,
            Boards::Serial(_) if summary.work_hz > 0 => Unit::Microseconds,
            Boards::Serial(_) => Unit::CounterTicks,
        };
        let counted = |work: &Work| Taken {
            mean: unit.of(work.mean(), summary.work_hz),
            max: unit.of(f64::from(work.max), summary.work_hz),
        };
        let (emulator, link) = match boards {
            Boards::Emulated(fleet) => (
                Some(format!("QEMU {}", fleet.emulator().version())),
                fleet.link().to_string(),
            ),
            Boards::Serial(board) => (None, format!("serial:{}", board.path().display())),
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
            board: summary.board.clone(),
            emulator,
            link,
            unit,
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

impl Unit {
    /// What so many ticks of a counter are in it, of which there are `work_hz` in a second.
    fn of(self, ticks: f64, work_hz: u32) -> f64 {
        match self {
            Self::Instructions => instructions(ticks, work_hz),
            Self::Microseconds => 1e6 * ticks / f64::from(work_hz),
            Self::CounterTicks => ticks,
        }
    }

    /// A line of the table.
    fn line(self, taken: &Taken) -> String {
        let Taken { mean, max } = taken;
        match self {
            Self::Instructions => format!("{mean:.0} instructions a tick, at most {max:.0}"),
            Self::Microseconds => {
                format!("{mean:.1} us a tick, at most {max:.1}, by the board's counter")
            }
            Self::CounterTicks => {
                format!("{mean:.0} ticks of the board's counter a tick, at most {max:.0}")
            }
        }
    }
}

impl Display for DeviceReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "board       {}", self.board)?;
        if let Some(emulator) = &self.emulator {
            write!(f, " in {emulator}")?;
        }
        writeln!(f, ", link {}", self.link)?;
        writeln!(f, "work        {}", self.unit.line(&self.tick))?;
        if let Some(scoring) = &self.scoring {
            writeln!(f, "scoring     {}", self.unit.line(scoring))?;
        }
        match self.stack_high_water {
            0 => writeln!(f, "stack       not measured by this board")?,
            bytes => writeln!(f, "stack       {bytes} bytes at most")?,
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::serial::SerialBoard;

    #[test]
    fn what_a_board_of_one_s_own_counts_is_never_called_instructions() {
        // Nothing is opened, so any file will do.
        let board = SerialBoard::find("/dev/null".as_ref(), 250_000).unwrap();
        let boards = Boards::Serial(board);
        let mut summary = DeviceSummary::default();
        summary.work.add(16_800);
        summary.scoring.add(168);
        let table = |work_hz| {
            summary.work_hz = work_hz;
            DeviceReport::of(&boards, &summary).to_string()
        };
        let [known, unknown] = [168_000_000, 0].map(table);
        for line in [
            "work        100.0 us a tick, at most 100.0, by the board's counter\n",
            "scoring     1.0 us a tick",
        ] {
            assert!(known.contains(line), "{known}");
        }
        assert!(
            unknown.contains("work        16800 ticks of the board's counter a tick"),
            "{unknown}"
        );
        assert!(!(known + &unknown).contains("instructions"));
    }
}
