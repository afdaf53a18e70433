//! The flights of `firmware-sim fly`: which plant, which pilot, side by side or one after the other.

use std::fmt::Display;
use std::num::NonZeroUsize;
use std::path::Path;
use std::thread;

use ted_policy::Artifact;

use super::boards::Boards;
use super::device_report::DeviceReport;
use super::fly::FlyArgs;
use super::report::Report;
use super::seat;
use crate::controller::Controller;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::interrupt;
use crate::plant::{Plant, PlantError};
use crate::plants::fault::FaultInjector;
use crate::plants::recorder::{Recorder, Shelf};
use crate::plants::recording::{RecordingShape, Recordings};
use crate::plants::replay::ReplayPlant;
use crate::progress::Progress;
use crate::remote::{RemoteController, RemoteError, Stream};
use crate::rollout::{
    DeviceSummary, Flight, FlyError, Pilot, abreast, episode_seeds, fly, fly_episode, fly_with,
};
use crate::worlds::{self, World};

/// The report of a flight, and whether what was to be recorded of it was written.
pub type Flown = (Report, Result<(), Failure>);

/// What is flown, and where the controller is.
pub struct Crew<'c> {
    /// The command line.
    pub args: &'c FlyArgs,
    /// The artefact.
    pub artifact: &'c Artifact<'c>,
    /// Its bytes, for a board.
    pub bytes: &'c [u8],
    /// The boards; none to fly on this machine.
    pub boards: Option<Boards>,
}

impl Crew<'_> {
    /// In the world of the task that is asked for, or else of the one that the policy was trained for.
    pub fn fly_task(&self) -> Result<Flown, Failure> {
        let trained_for = self.artifact.contract().task;
        let usage = |error: &dyn Display| Failure::new(ExitCode::Usage, error);
        let untold = |_| {
            usage(&format_args!(
                "the policy was made for {trained_for:?}, which is a task of no world that is known here: name another \
                 --plant, a --task, or a --world of your own"
            ))
        };
        let task = match &self.args.task {
            Some(task) => worlds::single(task).map_err(|error| usage(&error))?,
            None => worlds::single(trained_for).map_err(untold)?,
        };
        self.fly_in(World::Listed(task))
    }

    pub fn fly_in(&self, world: World) -> Result<Flown, Failure> {
        let world = world
            .ready(self.args.engine, self.args.output.audience())
            .map_err(|error| Failure::new(error.exit_code(), error))?;
        // A device flies one plant at a time.
        let plants = match self.boards {
            None => abreast(self.args.episodes as usize, self.workers()),
            Some(_) => 1,
        };
        let period_us = self.artifact.terms().control_period_us;
        let (report, recorded) = self.fly_many(|| world.plants(plants, period_us))?;
        let report = Report {
            engine: world.engine(),
            ..report.in_world(world.world())
        };
        Ok((report, recorded))
    }

    pub fn fly_many<P: Plant>(
        &self,
        make_plants: impl Fn() -> Result<Vec<P>, PlantError> + Sync,
    ) -> Result<Flown, Failure> {
        if let Some(path) = &self.args.record {
            let shelf = Shelf::default();
            let recorded = |plant| Recorder::new(plant, shelf.clone());
            let flown =
                self.fly_side_by_side(|| Ok(make_plants()?.into_iter().map(recorded).collect()));
            // Also after a flight that ended early: what was recorded by then is whole.
            let recorded = self.write_recordings(&shelf, path);
            Ok((flown?, recorded))
        } else if self.args.fault.is_empty() {
            Ok((self.fly_side_by_side(make_plants)?, Ok(())))
        } else {
            let faulty = |plant| FaultInjector::new(plant, self.args.fault.clone(), self.args.seed);
            let report =
                self.fly_side_by_side(|| Ok(make_plants()?.into_iter().map(faulty).collect()))?;
            Ok((report, Ok(())))
        }
    }

    fn fly_side_by_side<P: Plant>(
        &self,
        make_plants: impl Fn() -> Result<Vec<P>, PlantError> + Sync,
    ) -> Result<Report, Failure> {
        let workers = self.workers();
        let seeds = episode_seeds(self.args.seed, self.args.episodes as usize);
        let progress =
            self.args
                .output
                .audience()
                .start("fly", u64::from(self.args.episodes), "episodes");
        let stop = interrupt::requested;
        let landed = |_: &_| progress.advance(1);
        let flight = match &self.boards {
            None => {
                let numeric = self.args.seat.numeric;
                fly(
                    self.artifact,
                    numeric,
                    make_plants,
                    &seeds,
                    workers,
                    stop,
                    landed,
                )
            }
            Some(boards) => {
                let workers = workers.min(boards.limit());
                fly_with(
                    || self.pilot(boards, &progress),
                    make_plants,
                    &seeds,
                    workers,
                    stop,
                    landed,
                )
            }
        };
        progress.finish();
        Ok(Report {
            seed: Some(self.args.seed),
            ..self.report(&flight?)
        })
    }

    fn workers(&self) -> NonZeroUsize {
        let cores = || thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
        self.args.workers.unwrap_or_else(cores)
    }

    fn write_recordings(&self, shelf: &Shelf, path: &Path) -> Result<(), Failure> {
        let seeds = episode_seeds(self.args.seed, self.args.episodes as usize);
        let mut episodes = shelf.take();
        episodes.sort_by_key(|episode| seeds.iter().position(|&seed| seed == episode.seed));
        let shape = RecordingShape::of(&self.artifact.contract());
        Recordings { shape, episodes }
            .write(path)
            .map_err(|error| Failure::new(error.exit_code(), error))
    }

    pub fn fly_recording(&self) -> Result<Report, Failure> {
        let path = self.args.recording.clone().unwrap_or_default();
        let bad = |error: &dyn Display| {
            Failure::new(
                ExitCode::BadInput,
                format_args!("read recording {}: {error}", path.display()),
            )
        };
        let Recordings { shape, episodes } =
            Recordings::read(&path).map_err(|error| bad(&error))?;
        let replay = ReplayPlant::new(shape, episodes).map_err(|error| bad(&error))?;
        let seeds: Vec<u64> = replay.seeds().collect();
        let mut plant = FaultInjector::new(replay, self.args.fault.clone(), self.args.seed);
        let audience = self.args.output.audience();
        let progress = audience.start("replay", seeds.len() as u64, "episodes");
        let flight = match &self.boards {
            None => {
                let numeric = self.args.seat.numeric;
                let mut controller =
                    Controller::load(self.artifact, numeric).map_err(FlyError::Load)?;
                self.replay(&mut controller, &mut plant, &seeds, &progress)?
            }
            Some(boards) => {
                let pilot = self.pilot(boards, &progress);
                let mut pilot = pilot.map_err(FlyError::NoPilot)?;
                self.replay(&mut pilot, &mut plant, &seeds, &progress)?
            }
        };
        progress.finish();
        Ok(Report {
            largest_difference: plant.inner().largest_difference(),
            ..self.report(&flight)
        })
    }

    /// The same for every kind of pilot.
    fn replay(
        &self,
        pilot: &mut impl Pilot,
        plant: &mut impl Plant,
        seeds: &[u64],
        progress: &Progress,
    ) -> Result<Flight, Failure> {
        let mut flight = Flight::default();
        let mut debriefs = Vec::new();
        for &seed in seeds {
            if interrupt::requested() {
                let flown = flight.episodes.len();
                return Err(FlyError::Interrupted { flown }.into());
            }
            let (episode, times) = fly_episode(pilot, plant, seed)?;
            debriefs.extend(pilot.debrief()?);
            flight.episodes.push(episode);
            flight.tick_times.append(times);
            progress.advance(1);
        }
        flight.device = DeviceSummary::of(debriefs);
        Ok(flight)
    }

    /// The work that waits for it shows how far it is.
    fn pilot(
        &self,
        boards: &Boards,
        waiting: &Progress,
    ) -> Result<RemoteController<Box<dyn Stream>>, RemoteError> {
        let connection = seat::connect(boards, self.artifact, self.bytes, waiting)?;
        Ok(RemoteController::new(connection, self.args.seat.start()))
    }

    fn report(&self, flight: &Flight) -> Report {
        let device = self.boards.as_ref().zip(flight.device.as_ref());
        Report {
            device: device.map(|(boards, summary)| DeviceReport::of(boards, summary)),
            ..Report::of(flight, self.artifact)
        }
    }
}
