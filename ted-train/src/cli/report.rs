//! `ted report`: what became of a run, on one page.

use std::error::Error;
use std::path::{Path, PathBuf};

use clap::Args;
use firmware_sim::failure::Failure;
use firmware_sim::output::OutputArgs;
use firmware_sim::progress::Audience;
use serde::Serialize;

use crate::fleet::{Datasets, Lane};
use crate::report::{Verdict, report};
use crate::run::{REPORT, RunFolder};

use super::failures::end;
use super::locate::located;

const EXAMPLES: &str = "\
Examples:
  ted report runs/drawer-open-v3/steer/seed-0
  ted report runs/drawer-open-v3/steer/seed-0 --out drawer.html

The page is one file, without scripts and without anything from the network. `ted train` of one run and `ted quickstart` make it by themselves. \
If a clone of the same logs (--preset bc) lies beside the run and was flown, the policy is compared with it.";

/// Write what became of a run as one page: questions and answers, predictions, learning, flights, integers
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct ReportArgs {
    /// The folder of the run
    run: PathBuf,
    /// The file to write; report.html in the folder of the run if not given
    #[arg(long)]
    out: Option<PathBuf>,
    /// The dataset, if it is no longer where the run found it
    #[arg(long)]
    dataset: Option<String>,
    #[command(flatten)]
    output: OutputArgs,
}

/// What the command prints.
#[derive(Debug, Serialize)]
struct Written<'a> {
    report: &'a Path,
    verdict: &'a Verdict,
}

pub(super) fn run(args: &ReportArgs) -> Result<(), Failure> {
    let folder = RunFolder::open(&args.run).map_err(end)?;
    let (at, dataset) = located(&folder, args.dataset.as_deref())?;
    let out = args.out.clone().unwrap_or_else(|| folder.file(REPORT));
    let verdict = report(&folder, &dataset, &at, &out, args.output.audience()).map_err(end)?;
    let written = Written {
        report: &out,
        verdict: &verdict,
    };
    args.output.print(&written, || {
        format!("{}\nwrote {}", verdict.words, out.display())
    })
}

/// Writes the page of a run that has just ended. The run is what it is without it: what goes wrong is said, and no failure.
pub(super) fn of_a_run(lane: &Lane, datasets: &Datasets, audience: Audience) -> Option<PathBuf> {
    let write = || -> Result<PathBuf, Box<dyn Error>> {
        let folder = RunFolder::open(&lane.folder)?;
        let dataset = datasets.open(&lane.dataset)?;
        let out = folder.file(REPORT);
        report(&folder, &dataset, &lane.dataset, &out, audience)?;
        Ok(out)
    };
    match write() {
        Ok(out) => Some(out),
        Err(error) => {
            audience.note(&format!("there is no report: {error}"));
            None
        }
    }
}
