//! `firmware-sim fly`: episodes of an artefact on a plant, and how they went.

use std::fmt::Display;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::thread;

use clap::{Args, ValueEnum};
use ted_policy::{Artifact, ArtifactBytes};

use super::report::Report;
use crate::bridge::environment;
use crate::controller::{Controller, Numeric};
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::output::OutputArgs;
use crate::plant::{Plant, PlantError};
use crate::plants::fault::{FaultInjector, FaultPlan};
use crate::plants::metaworld::MetaWorldPlant;
use crate::plants::recorder::{Recorder, Shelf};
use crate::plants::recording::{RecordingShape, Recordings};
use crate::plants::replay::ReplayPlant;
use crate::plants::toy::ToyPlant;
use crate::rollout::{Flight, FlyError, episode_seeds, fly, fly_episode};
use crate::{disk, interrupt, tasks};

const EXAMPLES: &str = "\
Examples:
  firmware-sim fly policy.ted --task drawer-open-v3 --episodes 50
  firmware-sim fly policy.ted --task drawer-open-v3 --episodes 5 --fault nan@40 --json
  firmware-sim toy toy.ted && firmware-sim fly toy.ted --plant toy --record flight.json
  firmware-sim fly toy.ted --plant replay --recording flight.json

Exit codes: 0 flown without a fault, 2 usage, 3 the artefact or recording is broken, 4 Python or the \
simulator is missing or failed, 6 a file cannot be written, 7 the controller latched a fault, 130 interrupted.";

/// Fly an artefact behind the controller and report return, score, success, tick times and faults
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct FlyArgs {
    /// The artefact
    policy: PathBuf,
    /// The Meta-World task; the one the policy was trained for if not given
    #[arg(long)]
    task: Option<String>,
    /// How many episodes
    #[arg(long, default_value_t = 50, value_parser = clap::value_parser!(u32).range(1..))]
    episodes: u32,
    /// The root seed that the episodes' seeds are derived from
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// How many plants side by side; all cores if not given. Changes nothing but the time
    #[arg(long)]
    workers: Option<NonZeroUsize>,
    /// What to fly
    #[arg(long, value_enum, default_value_t = PlantKind::Metaworld)]
    plant: PlantKind,
    /// The recording to show to the policy, with --plant replay: all of its episodes
    #[arg(long, value_name = "FILE", required_if_eq("plant", "replay"))]
    recording: Option<PathBuf>,
    /// Write what was seen and sent to a recording
    #[arg(long, value_name = "FILE", conflicts_with_all = ["fault", "recording"])]
    record: Option<PathBuf>,
    /// Inject a fault, KIND@TICK, KIND@TICK+COUNT or KIND~PROBABILITY; may be given several times
    #[arg(long, value_name = "FAULT")]
    fault: Vec<FaultPlan>,
    #[command(flatten)]
    output: OutputArgs,
}

/// The plants that can be flown from the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum PlantKind {
    /// MuJoCo Meta-World, in Python processes
    Metaworld,
    /// A point on a table; needs no Python
    Toy,
    /// A recording: the report says how far the policy's actions are from the recorded ones
    Replay,
}

/// Flies, and prints the report.
pub fn run(args: &FlyArgs) -> Result<ExitCode, Failure> {
    check(args)?;
    let bytes = ArtifactBytes::read(&args.policy)
        .map_err(|error| Failure::new(ExitCode::BadInput, error))?;
    let artifact = Artifact::parse(&bytes).map_err(|error| {
        Failure::new(
            ExitCode::BadInput,
            format_args!("read {}: {error}", args.policy.display()),
        )
    })?;
    interrupt::install()
        .map_err(|error| Failure::new(ExitCode::Failure, format_args!("catch Ctrl-C: {error}")))?;
    let (flight, recorded) = match args.plant {
        PlantKind::Metaworld => fly_metaworld(args, &artifact)?,
        PlantKind::Toy => fly_many(args, &artifact, || Ok(ToyPlant::new()))?,
        PlantKind::Replay => (fly_recording(args, &artifact)?, Ok(())),
    };
    let report = Report {
        policy: args.policy.display().to_string(),
        plant: args
            .plant
            .to_possible_value()
            .map_or_else(String::new, |value| value.get_name().to_owned()),
        injected: args.fault.iter().map(FaultPlan::to_string).collect(),
        ..flight
    };
    args.output.print(&report, || report.to_string())?;
    recorded?;
    Ok(if report.faulted > 0 {
        ExitCode::Faulted
    } else {
        ExitCode::Success
    })
}

/// Refuses options that would be ignored, and a recording that could not be written in the end.
fn check(args: &FlyArgs) -> Result<(), Failure> {
    let usage = |message: &str| Err(Failure::new(ExitCode::Usage, message));
    if args.recording.is_some() && args.plant != PlantKind::Replay {
        return usage(
            "--recording is what --plant replay shows: add that, or leave the recording out",
        );
    }
    if args.task.is_some() && args.plant != PlantKind::Metaworld {
        return usage("--task names a Meta-World task: leave it out, or fly --plant metaworld");
    }
    match &args.record {
        Some(path) => {
            disk::check_writable(path).map_err(|error| Failure::new(error.exit_code(), error))
        }
        None => Ok(()),
    }
}

/// The report of a flight, and whether what was to be recorded of it was written.
type Flown = (Report, Result<(), Failure>);

fn fly_metaworld(args: &FlyArgs, artifact: &Artifact<'_>) -> Result<Flown, Failure> {
    let trained_for = artifact.contract().task;
    let usage = |error: &dyn Display| Failure::new(ExitCode::Usage, error);
    let task = match &args.task {
        Some(task) => tasks::single(task).map_err(|error| usage(&error))?,
        None => tasks::single(trained_for).map_err(|_| {
            usage(&format_args!(
                "the policy was made for {trained_for:?}, which is no Meta-World task: name another --plant, or a --task"
            ))
        })?,
    };
    let environment = environment::ensure(args.output.audience())
        .map_err(|error| Failure::new(error.exit_code(), error))?;
    let (report, recorded) = fly_many(args, artifact, || {
        MetaWorldPlant::new(&environment, task).map_err(PlantError::link)
    })?;
    Ok((report.on_task(task), recorded))
}

fn fly_many<P: Plant>(
    args: &FlyArgs,
    artifact: &Artifact<'_>,
    make_plant: impl Fn() -> Result<P, PlantError> + Sync,
) -> Result<Flown, Failure> {
    if let Some(path) = &args.record {
        let shelf = Shelf::default();
        let flown = fly_side_by_side(args, artifact, || {
            Ok(Recorder::new(make_plant()?, shelf.clone()))
        });
        // Also after a flight that ended early: what was recorded by then is whole.
        let recorded = write_recordings(args, artifact, &shelf, path);
        Ok((flown?, recorded))
    } else if args.fault.is_empty() {
        Ok((fly_side_by_side(args, artifact, make_plant)?, Ok(())))
    } else {
        let faulty = || {
            Ok(FaultInjector::new(
                make_plant()?,
                args.fault.clone(),
                args.seed,
            ))
        };
        Ok((fly_side_by_side(args, artifact, faulty)?, Ok(())))
    }
}

fn fly_side_by_side<P: Plant>(
    args: &FlyArgs,
    artifact: &Artifact<'_>,
    make_plant: impl Fn() -> Result<P, PlantError> + Sync,
) -> Result<Report, Failure> {
    let cores = || thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
    let workers = args.workers.unwrap_or_else(cores);
    let seeds = episode_seeds(args.seed, args.episodes as usize);
    let progress = args
        .output
        .audience()
        .start("fly", u64::from(args.episodes), "episodes");
    let flight = fly(
        artifact,
        Numeric::F32,
        make_plant,
        &seeds,
        workers,
        interrupt::requested,
        |_| progress.advance(1),
    );
    progress.finish();
    Ok(Report {
        seed: Some(args.seed),
        ..Report::of(&flight?, artifact)
    })
}

fn write_recordings(
    args: &FlyArgs,
    artifact: &Artifact<'_>,
    shelf: &Shelf,
    path: &Path,
) -> Result<(), Failure> {
    let seeds = episode_seeds(args.seed, args.episodes as usize);
    let mut episodes = shelf.take();
    episodes.sort_by_key(|episode| seeds.iter().position(|&seed| seed == episode.seed));
    let contract = artifact.contract();
    let shape = RecordingShape {
        observation_dim: contract.observation.len(),
        action_dim: contract.action.len(),
        control_period_us: contract.control_period_us,
    };
    Recordings { shape, episodes }
        .write(path)
        .map_err(|error| Failure::new(error.exit_code(), error))
}

fn fly_recording(args: &FlyArgs, artifact: &Artifact<'_>) -> Result<Report, Failure> {
    let path = args.recording.clone().unwrap_or_default();
    let bad = |error: &dyn Display| {
        Failure::new(
            ExitCode::BadInput,
            format_args!("read recording {}: {error}", path.display()),
        )
    };
    let Recordings { shape, episodes } = Recordings::read(&path).map_err(|error| bad(&error))?;
    let replay = ReplayPlant::new(shape, episodes).map_err(|error| bad(&error))?;
    let seeds: Vec<u64> = replay.seeds().collect();
    let mut controller = Controller::load(artifact, Numeric::F32).map_err(FlyError::Load)?;
    let mut plant = FaultInjector::new(replay, args.fault.clone(), args.seed);
    let progress = args
        .output
        .audience()
        .start("replay", seeds.len() as u64, "episodes");
    let mut flight = Flight::default();
    for seed in seeds {
        if interrupt::requested() {
            return Err(FlyError::Interrupted {
                flown: flight.episodes.len(),
            }
            .into());
        }
        let (episode, times) = fly_episode(&mut controller, &mut plant, seed)?;
        flight.episodes.push(episode);
        flight.tick_times.append(times);
        progress.advance(1);
    }
    progress.finish();
    Ok(Report {
        largest_difference: plant.inner().largest_difference(),
        ..Report::of(&flight, artifact)
    })
}
