//! How the runs of a fleet ended.

use std::path::PathBuf;

use serde::Serialize;

use super::failures::Ends;
use super::run_report::Sure;
use super::table::{Align, Table};
use crate::evaluate::Evaluation;
use crate::fleet::{Lane, LaneError, Trained};

/// Every run, in the order in which they were planned.
#[derive(Debug, Serialize)]
pub(super) struct FleetReport<'t> {
    runs: Vec<Run<'t>>,
}

/// One run.
#[derive(Debug, Serialize)]
struct Run<'t> {
    folder: PathBuf,
    preset: &'static str,
    seed: u64,
    artefact: Option<PathBuf>,
    evaluation: Option<Evaluation>,
    #[serde(flatten)]
    sure: Option<Sure<'t>>,
    failure: Option<RunFailure>,
}

/// Why it failed.
#[derive(Debug, Serialize)]
struct RunFailure {
    message: String,
    exit_code: u8,
}

impl<'t> FleetReport<'t> {
    pub(super) fn of(lanes: &[Lane], ends: &'t [Result<Trained, LaneError>]) -> Self {
        let runs = lanes.iter().zip(ends).map(|(lane, end)| Run {
            folder: lane.folder.clone(),
            preset: lane.config.preset.name(),
            seed: lane.config.seed,
            artefact: end.as_ref().ok().and_then(|it| it.artefact.clone()),
            evaluation: end.as_ref().ok().and_then(|it| it.evaluation.clone()),
            sure: end.as_ref().ok().and_then(Sure::of),
            failure: end.as_ref().err().map(|error| RunFailure {
                message: error.to_string(),
                exit_code: error.exit_code().code(),
            }),
        });
        Self {
            runs: runs.collect(),
        }
    }

    pub(super) fn text(&self) -> String {
        let mut table = Table::new(&[
            ("run", Align::Left),
            ("mean return", Align::Right),
            ("score", Align::Right),
            ("success", Align::Right),
            ("", Align::Left),
        ]);
        for run in &self.runs {
            let number = |digits: usize, value: Option<f64>| {
                value.map_or_else(|| "-".to_owned(), |it| format!("{it:.digits$}"))
            };
            let flown = run.evaluation.as_ref();
            table.row([
                run.folder.display().to_string(),
                number(1, flown.map(|it| it.return_mean)),
                number(3, flown.and_then(|it| it.score)),
                number(2, flown.map(|it| it.success)),
                run.failure
                    .as_ref()
                    .map_or_else(String::new, |it| it.message.clone()),
            ]);
        }
        let sure = self.runs.iter().filter_map(|run| {
            let sure = run.sure.as_ref()?;
            Some(format!("\n{}: {}", run.folder.display(), sure.statement()))
        });
        table.text() + &sure.collect::<String>()
    }
}
