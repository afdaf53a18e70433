//! `firmware-sim fly`: episodes of an artefact on a plant, and how they went.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::artefact;
use super::flights::Crew;
use super::report::Report;
use super::seat::SeatArgs;
use crate::bridge::Engine;
use crate::counts::{EPISODES, at_a_time};
use crate::device::message::Refusal;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::output::OutputArgs;
use crate::plants::fault::FaultPlan;
use crate::plants::toy::{ToyPlant, Units};
use crate::worlds::{OwnWorld, World};
use crate::{disk, interrupt};

const EXAMPLES: &str = "\
Examples:
  firmware-sim fly policy.ted --task drawer-open-v3 --episodes 50
  firmware-sim fly policy.ted --task drawer-open-v3 --episodes 5 --fault nan@40 --json
  firmware-sim toy toy.ted && firmware-sim fly toy.ted --plant toy --record flight.json
  firmware-sim fly toy.ted --plant replay --recording flight.json
  firmware-sim fly toy.ted --plant toy --on mps2-an386
  firmware-sim fly policy.ted --world my_world.py --episodes 20
  firmware-sim fly policy.ted --task drawer-open-v3 --episodes 5 --on mps2-an505 --link uart --numeric integer
  firmware-sim fly policy.ted --task drawer-open-v3 --episodes 5 --on serial:/dev/ttyACM0 --numeric integer

On a board the same controller flies from the same artefact and gives the same report, to the bit; beside it the report \
says what a tick took: in instructions of the emulated processor, not in cycles of a real one, or in microseconds by the \
counter of a board of your own.

Exit codes: 0 flown without a fault, 2 usage, 3 the artefact or recording is broken, 4 Python, the simulator, QEMU, \
the firmware or the board is missing or failed, 5 somebody else has the flash image or the serial port, 6 a file cannot be written, 7 the controller latched a fault, 130 interrupted.";

/// Fly an artefact behind the controller and report return, score, success, tick times and faults
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct FlyArgs {
    /// The artefact
    policy: PathBuf,
    /// The task; the one the policy was trained for if not given
    #[arg(long)]
    pub task: Option<String>,
    /// A world of your own to fly in: a Python file with make(), reset() and step(), or gym: and the id of an environment
    #[arg(long, value_name = "FILE|gym:ID", conflicts_with_all = ["task", "plant"])]
    pub world: Option<OwnWorld>,
    /// How many episodes
    #[arg(long, default_value_t = 50, value_parser = clap::value_parser!(u32).range(EPISODES))]
    pub episodes: u32,
    /// The root seed that the episodes' seeds are derived from
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// How Meta-World is simulated; both engines fly the same episodes, to the bit
    #[arg(long, value_enum, default_value_t)]
    pub engine: Engine,
    /// How many simulators side by side; all cores if not given. Changes nothing but the time
    #[arg(long, value_parser = at_a_time)]
    pub workers: Option<NonZeroUsize>,
    /// What to fly
    #[arg(long, value_enum, default_value_t = PlantKind::World)]
    plant: PlantKind,
    /// The recording to show to the policy, with --plant replay: all of its episodes
    #[arg(long, value_name = "FILE", required_if_eq("plant", "replay"))]
    pub recording: Option<PathBuf>,
    /// Write what was seen and sent to a recording
    #[arg(long, value_name = "FILE", conflicts_with_all = ["fault", "recording"])]
    pub record: Option<PathBuf>,
    /// Inject a fault, KIND@TICK, KIND@TICK+COUNT or KIND~PROBABILITY; may be given several times
    #[arg(long, value_name = "FAULT")]
    pub fault: Vec<FaultPlan>,
    #[command(flatten)]
    pub seat: SeatArgs,
    #[command(flatten)]
    pub output: OutputArgs,
}

/// Episodes that a recording may have: a gigabyte or two of Meta-World.
const MOST_RECORDED: u32 = 10_000;

/// The plants that can be flown from the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum PlantKind {
    /// The world of the task
    World,
    /// A point on a table; needs no Python
    Toy,
    /// A recording: the report says how far the policy's actions are from the recorded ones
    Replay,
}

/// Flies, and prints the report.
pub fn run(args: &FlyArgs) -> Result<ExitCode, Failure> {
    check(args)?;
    let bytes = artefact::read(&args.policy)?;
    let artifact = artefact::parse(&bytes, &args.policy)?;
    if !artifact.terms().declared && args.plant != PlantKind::Replay {
        return Err(Failure::new(
            ExitCode::BadInput,
            format_args!("fly {}: {}", args.policy.display(), Refusal::Undeclared),
        ));
    }
    interrupt::install()
        .map_err(|error| Failure::new(ExitCode::Failure, format_args!("catch Ctrl-C: {error}")))?;
    let crew = Crew {
        args,
        artifact: &artifact,
        bytes: &bytes,
        boards: args.seat.boards(bytes.len(), args.output.audience())?,
    };
    let (flight, recorded) = match (args.plant, &args.world) {
        (_, Some(own)) => crew.fly_in(World::Own(own.clone()))?,
        (PlantKind::World, None) => crew.fly_task()?,
        (PlantKind::Toy, None) => {
            let units = Units::of_task(artifact.contract().task).unwrap_or_default();
            crew.fly_many(|| Ok(vec![ToyPlant::in_units(units)]))?
        }
        (PlantKind::Replay, None) => (crew.fly_recording()?, Ok(())),
    };
    let report = Report {
        policy: args.policy.display().to_string(),
        plant: match args.plant {
            PlantKind::World => flight.plant,
            kind => (kind.to_possible_value())
                .map_or_else(String::new, |value| value.get_name().to_owned()),
        },
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
    if args.task.is_some() && args.plant != PlantKind::World {
        return usage("--task names a task of a world: leave it out, or fly --plant world");
    }
    match &args.record {
        Some(_) if args.episodes > MOST_RECORDED => Err(Failure::new(
            ExitCode::Usage,
            format_args!(
                "--record keeps all of a flight in memory: at most {MOST_RECORDED} episodes, or leave it out"
            ),
        )),
        Some(path) => {
            disk::check_writable(path).map_err(|error| Failure::new(error.exit_code(), error))
        }
        None => Ok(()),
    }
}
