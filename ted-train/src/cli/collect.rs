//! `ted collect`: datasets of Meta-World, and of the toy.

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::thread;

use clap::Args;
use firmware_sim::bridge::Engine;
use firmware_sim::counts::at_a_time;
use firmware_sim::exit::ExitCode;
use firmware_sim::failure::Failure;
use firmware_sim::output::OutputArgs;
use firmware_sim::worlds;

use crate::collect::{CollectConfig, CollectReport, Recipe, run_anywhere};

use super::failures::end;
use super::locate::datasets_root;

const EXAMPLES: &str = "\
Examples:
  ted collect --task drawer-open-v3                 the paper's 50 + 950 episodes
  ted collect --task example10 --workers 2          the ten tasks of the paper's Table 4
  ted collect --task box-close-v3 --episodes 40 --seed 1
  ted collect --task drawer-open-v3 --recipe drift  noise that is correlated in time
  ted collect --task faucet-open_faucet-close_first two intentions in one log, the first one's reward
  ted collect --task toy-micrometres                no Meta-World, and numbers of another size
  ted collect --task drawer-open-v3 --good 5        5 good episodes among 1,000

A stopped collection goes on where it was. The result is a Minari dataset:
  minari.load_dataset(\"ted/drawer-open-v3-paper-s0-v0\")";

/// Record datasets on MuJoCo Meta-World: the paper's recipe, or what makes learning harder
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct CollectArgs {
    /// A task such as drawer-open-v3, or a group: example10, all, two-intentions; or toy, toy-micrometres
    #[arg(long)]
    task: String,
    /// How the actions are made: paper (noisy and mostly random ones), biased (the paper's, all pushed the same way), drift (the
    /// paper's, with noise that is correlated in time), expert (the scripted policy's own)
    #[arg(long, default_value = "paper")]
    recipe: Recipe,
    /// Episodes for each task; the recipe's own number if not given
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    episodes: Option<u32>,
    /// Good episodes, which have noise and no random actions; one in twenty if not given
    #[arg(long)]
    good: Option<u32>,
    /// Root seed
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// How Meta-World is simulated; both engines play the same episodes, to the bit
    #[arg(long, value_enum, default_value_t)]
    engine: Engine,
    /// Simulator processes; all cores if not given. Changes nothing but the time
    #[arg(long, value_parser = at_a_time)]
    workers: Option<NonZeroUsize>,
    /// Folder of the datasets; $MINARI_DATASETS_PATH or ~/.minari/datasets if not given
    #[arg(long)]
    root: Option<PathBuf>,
    #[command(flatten)]
    output: OutputArgs,
}

pub(super) fn run(args: &CollectArgs) -> Result<(), Failure> {
    let tasks = worlds::resolve(&args.task).map_err(|e| Failure::new(ExitCode::Usage, e))?;
    let mut reports = Vec::new();
    for task in tasks {
        let config = CollectConfig {
            task: task.name().to_owned(),
            recipe: args.recipe,
            episodes: args.episodes,
            good: args.good,
            seed: args.seed,
            workers: workers(args.workers),
            root: args.root.clone().unwrap_or_else(datasets_root),
        };
        let report = run_anywhere(&config, args.engine, args.output.audience());
        reports.push(report.map_err(end)?);
    }
    args.output.print(&reports, || {
        reports.iter().map(text).collect::<Vec<_>>().join("\n\n")
    })
}

/// The number of workers a person asked for, or one for each core.
pub(super) fn workers(asked: Option<NonZeroUsize>) -> usize {
    asked
        .or_else(|| thread::available_parallelism().ok())
        .map_or(1, NonZeroUsize::get)
}

fn text(report: &CollectReport) -> String {
    let mut lines = vec![
        format!("{}  {}", report.dataset, report.folder.display()),
        format!(
            "{:<14} {:>9} {:>12} {:>12} {:>9}",
            "part", "episodes", "mean return", "max return", "success"
        ),
    ];
    for part in report.parts.iter().chain([&report.mix]) {
        lines.push(format!(
            "{:<14} {:>9} {:>12.1} {:>12.1} {:>9.3}",
            part.part, part.episodes, part.mean_return, part.max_return, part.success_rate
        ));
    }
    lines.join("\n")
}
