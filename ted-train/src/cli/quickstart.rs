//! `ted quickstart`: all of it, in minutes.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Args;
use firmware_sim::counts::at_a_time;
use firmware_sim::exit::ExitCode;
use firmware_sim::failure::Failure;
use firmware_sim::output::OutputArgs;
use firmware_sim::worlds::{self, OwnWorld, World};

use crate::collect::PartReport;
use crate::config::Preset;
use crate::evaluate::Evaluation;
use crate::fleet::Datasets;
use crate::quickstart::{Quickstart, QuickstartConfig, Setting, quickstart, record};
use crate::reward::episodes::Confidence;

use super::collect::workers;
use super::crosscheck::{text as crosscheck_text, verdict};
use super::door::{DoorArgs, Errand, door};
use super::failures::end;
use super::locate::dataset_path;
use super::table::{Align, Table};

const EXAMPLES: &str = "\
Examples:
  ted quickstart
  ted quickstart --task drawer-open-v3 --ask        you answer, on a web page
  ted quickstart --task drawer-open-v3 --episodes 1000 --steps 20000
  ted quickstart --dataset mine/puck-v0 --world puck.py --ask      your own logs, and your own world
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
    #[arg(long, default_value = DEFAULT_TASK, conflicts_with_all = ["dataset", "world"])]
    task: String,
    /// Your own logs instead of a task that is collected: a folder, or a Minari id. They are flown in --world
    #[arg(long, requires = "world", conflicts_with = "episodes")]
    dataset: Option<String>,
    /// A world of your own to fly in: a Python file with make(), reset() and step(), or gym: and the id of an environment
    #[arg(long, value_name = "FILE|gym:ID", requires = "dataset")]
    world: Option<OwnWorld>,
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
    let setting = match (&args.dataset, &args.world) {
        (Some(dataset), Some(world)) => {
            Setting::Own(dataset_path(dataset), World::Own(world.clone()))
        }
        _ => {
            let task = worlds::single(&args.task).map_err(|e| Failure::new(ExitCode::Usage, e))?;
            Setting::Collected(task, args.episodes)
        }
    };
    let mut config = QuickstartConfig {
        setting,
        out: args.out.clone(),
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
    // Logs without rewards have no returns.
    let known =
        |name, it: &PartReport| (name != "dataset" || report.rewarded).then_some(it.mean_return);
    let logs = |name, it: &PartReport| (name, it.episodes, known(name, it), it.success_rate);
    let flown = |name, it: &Evaluation| (name, it.returns.len(), Some(it.return_mean), it.success);
    let rows = [logs("dataset", dataset)]
        .into_iter()
        .chain(scripted.as_ref().map(|it| logs("scripted policy", it)))
        .chain([
            flown("clone of the dataset", cloned),
            flown("trained policy", trained),
        ]);
    for (name, episodes, mean_return, success) in rows {
        let score = mean_return.and_then(|it| trained.score_of(it));
        results.row([
            name.to_owned(),
            episodes.to_string(),
            mean_return.map_or_else(|| "-".to_owned(), |it| format!("{it:.1}")),
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
    let measure = trained.measure().map(|it| format!("Score: {it}."));
    let sure = report.confidence.as_ref().map(Confidence::in_words);
    [
        crosscheck_text(&report.crosscheck),
        paths.text(),
        results.text(),
        verdict.to_owned(),
    ]
    .into_iter()
    .chain(measure)
    .chain(sure)
    .collect::<Vec<_>>()
    .join("\n\n")
}
