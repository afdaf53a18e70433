//! `ted crosscheck`: is what flies what was trained?

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Args;
use firmware_sim::counts::at_a_time;
use firmware_sim::exit::ExitCode;
use firmware_sim::failure::Failure;
use firmware_sim::output::OutputArgs;

use crate::crosscheck::{Check, Crosscheck, CrosscheckConfig, crosscheck};
use crate::run::RunFolder;

use super::collect::workers;
use super::failures::end;
use super::locate::{artefact_of, dataset_of};
use super::table::{Align, Table};

const EXAMPLES: &str = "\
Examples:
  ted crosscheck runs/drawer-open-v3/steer/seed-0
  ted crosscheck runs/drawer-open-v3/true/seed-0 --sample 20000 --episodes 0 --json

Exit code 7 when something differs that must not.";

/// Compare burn, the device core, the artefact and the flight of a finished run, number by number
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct CrosscheckArgs {
    /// The run's folder
    run: PathBuf,
    /// Compare the actions for this many observations, drawn by the run's seed; all if not given
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    sample: Option<u32>,
    /// Episodes of the run's evaluation to fly again; 0 for none, which needs no simulator
    #[arg(long, default_value_t = 2)]
    episodes: u32,
    /// The dataset, if it is no longer where the run found it
    #[arg(long)]
    dataset: Option<String>,
    /// Simulator processes; all cores if not given. Changes nothing but the time
    #[arg(long, value_parser = at_a_time)]
    workers: Option<NonZeroUsize>,
    #[command(flatten)]
    output: OutputArgs,
}

pub(super) fn run(args: &CrosscheckArgs) -> Result<(), Failure> {
    let folder = RunFolder::open(&args.run).map_err(end)?;
    artefact_of(&folder)?;
    let dataset = dataset_of(&folder, args.dataset.as_deref())?;
    let config = CrosscheckConfig {
        sample: args.sample.map(|sample| sample as usize),
        episodes: args.episodes,
        workers: workers(args.workers),
    };
    let report = crosscheck(&folder, &dataset, &config, args.output.audience()).map_err(end)?;
    args.output.print(&report, || text(&report))?;
    verdict(&report)
}

/// A failure that names what differs, if something does.
pub(super) fn verdict(report: &Crosscheck) -> Result<(), Failure> {
    let failed: Vec<_> = report.checks.iter().filter(|check| !check.passed).collect();
    if failed.is_empty() {
        return Ok(());
    }
    let names: Vec<_> = failed.iter().map(|check| check.what).collect();
    Err(Failure::new(
        ExitCode::Faulted,
        format_args!(
            "{} of {} comparisons differ by more than they may: {}",
            failed.len(),
            report.checks.len(),
            names.join("; ")
        ),
    ))
}

/// The table that a person reads.
pub(super) fn text(report: &Crosscheck) -> String {
    let right = [
        "compared", "unequal", "max", "mean", "max ULP", "mean ULP", "allowed",
    ];
    let mut columns = vec![("comparison", Align::Left)];
    columns.extend(right.map(|name| (name, Align::Right)));
    columns.push(("", Align::Left));
    let mut table = Table::new(&columns);
    report.checks.iter().for_each(|check| table.row(row(check)));
    let mut lines = vec![
        format!("{} on {}", report.run.display(), report.dataset),
        format!("observations for the actions: {}", report.observations),
        table.text(),
    ];
    lines.extend(
        report
            .left_out
            .iter()
            .map(|what| format!("not compared: {what}")),
    );
    lines.join("\n")
}

fn row(check: &Check) -> Vec<String> {
    let number = |value: f64| match value {
        0.0 => "0".to_owned(),
        value => format!("{value:.1e}"),
    };
    let mut cells = vec![
        check.what.to_owned(),
        check.compared.to_string(),
        check.unequal.to_string(),
    ];
    cells.extend(match check.distance {
        Some(distance) => [
            number(distance.max_absolute),
            number(distance.mean_absolute),
            distance.max_ulp.to_string(),
            format!("{:.1}", distance.mean_ulp),
        ],
        None => ["-"; 4].map(str::to_owned),
    });
    cells.push(check.allowed.to_string());
    cells.push(if check.passed { "ok" } else { "DIFFERENT" }.to_owned());
    cells
}
