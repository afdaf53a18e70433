//! `ted eval`: the policy of a run, flown by the controller, or from here where no controller can fly it.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Args;
use firmware_sim::bridge::Engine;
use firmware_sim::controller::Numeric;
use firmware_sim::counts::{EPISODES, at_a_time};
use firmware_sim::exit::ExitCode;
use firmware_sim::failure::Failure;
use firmware_sim::output::OutputArgs;
use firmware_sim::worlds::{OwnWorld, World};
use ted_policy::{Artifact, ArtifactBytes};

use crate::config::Config;
use crate::evaluate::{EpisodeFault, EvaluateError, Evaluation, FlightPlan, Flyer, evaluate};
use crate::replay::{Replayed, replay};
use crate::run::{EVALUATION, RunFolder};
use crate::train::sequence_policy;

use super::collect::workers;
use super::failures::end;
use super::locate::{artefact_of, dataset_of};

const EXAMPLES: &str = "\
Examples:
  ted eval runs/drawer-open-v3/true/seed-0
  ted eval runs/drawer-open-v3/true/seed-0 --episodes 200 --seed 7 --json
  ted eval runs/drawer-open-v3/true/seed-0 --numeric integer
  ted eval runs/drawer-open-v3/true/seed-0 --replay
  ted eval runs/mine --world my_world.py

The episodes are those of `firmware-sim fly` with the same seed, and so are the returns of an artefact, to the bit. A policy for
sequences (oppo) is flown from here, behind the same checks. Exit code 7 when a check latched a fault.";

/// Fly the policy of a run in its world, or in one of your own, and report return, score and success; or show it the logs and move nothing
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct EvalArgs {
    /// The run's folder
    run: PathBuf,
    /// How many episodes
    #[arg(long, default_value_t = 50, value_parser = clap::value_parser!(u32).range(EPISODES))]
    episodes: u32,
    /// Root of the episodes' seeds; the run's seed if not given
    #[arg(long)]
    seed: Option<u64>,
    /// The task; the one it was trained for if not given
    #[arg(long)]
    task: Option<String>,
    /// A world of your own to fly in: a Python file with make(), reset() and step(), or gym: and the id of an environment
    #[arg(long, value_name = "FILE|gym:ID", conflicts_with = "task")]
    world: Option<OwnWorld>,
    /// In which numbers the policy computes
    #[arg(long, value_enum, default_value_t)]
    numeric: Numeric,
    /// How Meta-World is simulated; both engines fly the same episodes, to the bit
    #[arg(long, value_enum, default_value_t)]
    engine: Engine,
    /// Simulator processes; all cores if not given. Changes nothing but the time
    #[arg(long, value_parser = at_a_time)]
    workers: Option<NonZeroUsize>,
    /// Show the recorded observations of the run's dataset to the controller instead of flying: how far its actions are from
    /// the recorded ones, whether it would have stopped, and how many episodes it puts in the top k %. Needs no simulator
    #[arg(long, conflicts_with_all = ["episodes", "seed", "task", "workers", "engine", "world"])]
    replay: bool,
    /// The dataset to replay, or that a sequence policy was learned from, if it is no longer where the run found it
    #[arg(long)]
    dataset: Option<String>,
    #[command(flatten)]
    output: OutputArgs,
}

pub(super) fn run(args: &EvalArgs) -> Result<(), Failure> {
    let folder = RunFolder::open(&args.run).map_err(end)?;
    if args.replay {
        replay_logs(args, &folder)
    } else {
        fly_again(args, &folder)
    }
}

fn replay_logs(args: &EvalArgs, folder: &RunFolder) -> Result<(), Failure> {
    let dataset = dataset_of(folder, args.dataset.as_deref())?;
    let bytes =
        ArtifactBytes::read(artefact_of(folder)?).map_err(|e| end(EvaluateError::Load(e)))?;
    let artifact = Artifact::parse(&bytes).map_err(|e| end(EvaluateError::Artifact(e)))?;
    let report = replay(&artifact, args.numeric, &dataset, args.output.audience()).map_err(end)?;
    args.output.print(&report, || replay_text(&report))?;
    verdict(report.faults.len(), report.episodes)
}

fn fly_again(args: &EvalArgs, folder: &RunFolder) -> Result<(), Failure> {
    let config = Config::read(&folder.config_path()).map_err(end)?;
    let audience = args.output.audience();
    let plan = FlightPlan {
        episodes: args.episodes,
        seed: args.seed.unwrap_or(config.seed),
        workers: workers(args.workers),
        engine: args.engine,
    };
    let world = match (&args.world, &args.task) {
        (Some(own), _) => Some(World::Own(own.clone())),
        (None, Some(task)) => Some(World::of_task(task).map_err(|e| end(EvaluateError::Task(e)))?),
        (None, None) => None,
    };
    let refuse = |why: &str| Err(Failure::new(ExitCode::Usage, why));
    let report = if config.algorithm.makes_networks() {
        if args.dataset.is_some() {
            return refuse(
                "an artefact flies without a dataset: leave --dataset out, or add --replay",
            );
        }
        let artefact = artefact_of(folder)?;
        evaluate(
            Flyer::Artefact(&artefact, args.numeric),
            world,
            &plan,
            audience,
        )
    } else {
        if args.numeric != Numeric::F32 {
            return refuse("a sequence policy has no integer networks: leave --numeric out");
        }
        let dataset = dataset_of(folder, args.dataset.as_deref())?;
        match sequence_policy(folder, &dataset, audience).map_err(end)? {
            Some(oppo) => evaluate(Flyer::Sequence(&oppo, &dataset), world, &plan, audience),
            None => unreachable!("the algorithm makes no networks"),
        }
    }
    .map_err(end)?;
    // A run that was never flown is from now on, in a world of its own if no other is known.
    let of_the_run = args.task.is_none()
        && (args.world.is_none() || !simulated(folder))
        && report.seed == config.seed
        && report.numeric == Numeric::F32;
    if of_the_run && !folder.file(EVALUATION).exists() {
        folder.write_json(EVALUATION, &report).map_err(end)?;
    }
    args.output.print(&report, || text(&report))?;
    verdict(report.faulted, report.returns.len())
}

/// Whether the run's dataset is of a world that is known here.
fn simulated(folder: &RunFolder) -> bool {
    let dataset = dataset_of(folder, None).ok();
    let task = dataset.as_ref().and_then(|it| it.task());
    task.is_some_and(|task| World::of_task(task).is_ok())
}

/// A latched fault is a failure of its own kind.
fn verdict(faulted: usize, episodes: usize) -> Result<(), Failure> {
    match faulted {
        0 => Ok(()),
        faulted => Err(Failure::new(
            ExitCode::Faulted,
            format_args!("a fault was latched in {faulted} of {episodes} episodes"),
        )),
    }
}

fn replay_text(report: &Replayed) -> String {
    let difference = report.largest_difference.map_or_else(String::new, |worst| {
        format!(
            "\ndifference        at most {:.4} from the recorded actions (episode {}, step {}, action {})",
            worst.absolute, worst.seed, worst.step, worst.dimension
        )
    });
    let top_k = report.in_top_k.map_or_else(String::new, |in_top_k| {
        format!("\ntop k %           {in_top_k} episodes, as the controller scores them")
    });
    format!(
        "{dataset}: {episodes} episodes, {ticks} ticks\n\
         clamped           {clamped} ticks\n\
         slew-limited      {limited} ticks{difference}{top_k}\n\
         faulted episodes  {faulted}{faults}",
        dataset = report.dataset,
        episodes = report.episodes,
        ticks = report.ticks,
        clamped = report.clamped_ticks,
        limited = report.slew_limited_ticks,
        faulted = report.faults.len(),
        faults = report.faults.iter().map(fault_text).collect::<String>(),
    )
}

fn fault_text(fault: &EpisodeFault) -> String {
    let EpisodeFault {
        episode,
        tick,
        code,
        reason,
    } = fault;
    format!("\n  episode {episode}, tick {tick}: code {code}, {reason}")
}

/// The table that a person reads.
pub(super) fn text(report: &Evaluation) -> String {
    let score =
        |score: Option<f64>| score.map_or_else(|| "-".to_owned(), |score| format!("{score:.3}"));
    format!(
        "{task}: {episodes} episodes, seed {seed}{numeric}{engine}\n\
         return            {mean:.1} +- {sd:.1}\n\
         normalised score  {normalised}\n\
         success           {success:.3}\n\
         dataset           mean return {dataset_mean:.1}, largest {dataset_max:.1}\n\
         faulted episodes  {faulted}{faults}",
        task = report.task,
        numeric = match report.numeric {
            Numeric::F32 => "",
            Numeric::Integer => ", in integers",
        },
        episodes = report.returns.len(),
        seed = report.seed,
        engine = match report.world() {
            Some(world) if world.has_engines() => format!(", {} engine", report.engine),
            _ => String::new(),
        },
        mean = report.return_mean,
        sd = report.return_sd,
        normalised = score(report.score),
        success = report.success,
        dataset_mean = report.dataset_mean,
        dataset_max = report.dataset_max,
        faulted = report.faulted,
        faults = report.faults.iter().map(fault_text).collect::<String>(),
    )
}
