//! `ted quickstart`: all of it, in minutes.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Args;
use firmware_sim::counts::at_a_time;
use firmware_sim::exit::ExitCode;
use firmware_sim::failure::Failure;
use firmware_sim::output::OutputArgs;
use firmware_sim::rollout::normalised_score;
use firmware_sim::tasks;

use crate::config::Preset;
use crate::fleet::Datasets;
use crate::quickstart::{Quickstart, QuickstartConfig, quickstart, record};
use crate::reward::episodes::Confidence;

use super::collect::workers;
use super::crosscheck::{text as crosscheck_text, verdict};
use super::door::{DoorArgs, Errand, door};
use super::failures::end;
use super::table::{Align, Table};

const EXAMPLES: &str = "\
Examples:
  ted quickstart
  ted quickstart --task drawer-open-v3 --ask        you answer, on a web page
  ted quickstart --task drawer-open-v3 --episodes 1000 --steps 20000
  ted quickstart --json

Less than two minutes on two cores, and 700 MB for the simulator, which is installed first if it is not there.
A stopped quickstart goes on where it was. The method at full size: ted collect, ted train.";

/// A task on which the paper's method stays below the clone of the logs.
const DEFAULT_TASK: &str = "box-close-v3";

/// Collect, ask ten questions, learn a reward and a policy, export, fly and cross-check, at reduced size
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct QuickstartArgs {
    /// The task
    #[arg(long, default_value = DEFAULT_TASK)]
    task: String,
    /// The folder that everything is written to
    #[arg(long, default_value = "runs/quickstart")]
    out: PathBuf,
    /// Episodes to collect
    #[arg(long, default_value_t = 300, value_parser = clap::value_parser!(u32).range(1..))]
    episodes: u32,
    /// Updates of the policy, and of the clone of the same logs that flies beside it
    #[arg(long, default_value_t = 8_000, value_parser = clap::value_parser!(u64).range(1..=1_000_000_000))]
    steps: u64,
    /// Root of all randomness
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u64).range(..=i64::MAX as u64))]
    seed: u64,
    /// Simulator processes; all cores if not given. Changes nothing but the time
    #[arg(long, value_parser = at_a_time)]
    workers: Option<NonZeroUsize>,
    /// Answer the questions yourself, on a web page of this machine
    #[arg(long)]
    ask: bool,
    #[command(flatten)]
    door: DoorArgs,
    #[command(flatten)]
    output: OutputArgs,
}

pub(super) fn run(args: &QuickstartArgs) -> Result<(), Failure> {
    let task = tasks::single(&args.task).map_err(|e| Failure::new(ExitCode::Usage, e))?;
    let mut config = QuickstartConfig {
        task: task.to_owned(),
        out: args.out.clone(),
        episodes: args.episodes,
        steps: args.steps,
        seed: args.seed,
        workers: workers(args.workers),
        asked: args.ask.then(|| Preset::default().config().answers()),
    };
    args.door.check(args.ask)?;
    let audience = args.output.audience();
    let logs = record(&config, audience).map_err(end)?;
    if args.ask {
        let mut lane = config.lane(&logs).map_err(end)?;
        door(
            &mut lane,
            &Datasets::default(),
            &args.door,
            Errand::Train,
            audience,
        )?;
        config.asked = Some(lane.config.answers());
    }
    let report = quickstart(&config, &logs, audience).map_err(end)?;
    args.output.print(&report, || text(&report))?;
    verdict(&report.crosscheck)
}

fn text(report: &Quickstart) -> String {
    let mut results = Table::new(&[
        (&report.task, Align::Left),
        ("episodes", Align::Right),
        ("mean return", Align::Right),
        ("score", Align::Right),
        ("success", Align::Right),
    ]);
    let (cloned, trained) = (&report.cloned, &report.trained);
    let (dataset, scripted) = (&report.dataset, &report.scripted);
    for (name, episodes, mean_return, success) in [
        (
            "dataset",
            dataset.episodes,
            dataset.mean_return,
            dataset.success_rate,
        ),
        (
            "scripted policy",
            scripted.episodes,
            scripted.mean_return,
            scripted.success_rate,
        ),
        (
            "clone of the dataset",
            cloned.returns.len(),
            cloned.return_mean,
            cloned.success,
        ),
        (
            "trained policy",
            trained.returns.len(),
            trained.return_mean,
            trained.success,
        ),
    ] {
        let score = normalised_score(mean_return, trained.dataset_max);
        results.row([
            name.to_owned(),
            episodes.to_string(),
            format!("{mean_return:.1}"),
            score.map_or_else(|| "-".to_owned(), |score| format!("{score:.3}")),
            format!("{success:.2}"),
        ]);
    }
    let mut paths = Table::new(&[("written", Align::Left), ("", Align::Left)]);
    for written in &report.written {
        paths.row([written.what.to_owned(), written.path.display().to_string()]);
    }
    let verdict = if report.beats_clone {
        "A look at the logs and ten answers made more of them than imitating all of them does."
    } else {
        "The policy returns no more than the clone of its logs: give it more --episodes or --steps, or another --task."
    };
    let sure = report.confidence.as_ref().map(Confidence::in_words);
    [
        crosscheck_text(&report.crosscheck),
        paths.text(),
        results.text(),
        format!("{verdict} A score of 1 is the best episode of the data."),
    ]
    .into_iter()
    .chain(sure)
    .collect::<Vec<_>>()
    .join("\n\n")
}
