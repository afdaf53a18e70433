//! Flying episodes: a pilot and a plant in lockstep, many plants side by side, some of them abreast in one simulator.
//!
//! An episode is a function of the artefact, the kind of plant and the seed. Which worker flew it, and after what, makes
//! no difference, and neither does where the controller is; so the trainer's evaluation and `firmware-sim fly` agree to the bit.

mod crew;
mod debrief;
mod episode;
mod pilot;
mod score;
mod tick_times;

pub use debrief::{Debrief, DeviceLink, DeviceSummary, Work};
pub use episode::{EpisodeError, EpisodeReport, Latched, fly_episode};
pub use pilot::Pilot;
pub use score::{Summary, normalised_score};
pub use tick_times::TickTimes;

use std::num::NonZeroUsize;
use std::sync::mpsc;
use std::thread;

use ted_policy::{Artifact, ArtifactError};
use thiserror::Error;

use self::crew::{Crew, Landed};
use crate::controller::{Controller, Numeric};
use crate::exit::ExitCode;
use crate::plant::{Plant, PlantError};
use crate::remote::RemoteError;
use crate::splitmix::mix;

/// How many plants fly abreast in one simulator: more do not make it faster, and a worker's last episodes fly with fewer.
const ABREAST: usize = 8;

/// Keeps the seeds of evaluation apart from other uses of the same root seed.
const EVALUATION: u64 = 0x6576_616c_7561_7465;

/// The seed of evaluation episode `index` under a root seed. Everyone who evaluates flies these episodes.
#[must_use]
pub const fn episode_seed(root: u64, index: u64) -> u64 {
    mix(root ^ EVALUATION, index)
}

/// The seeds of the first `episodes` evaluation episodes under a root seed.
#[must_use]
pub fn episode_seeds(root: u64, episodes: usize) -> Vec<u64> {
    (0..episodes as u64)
        .map(|index| episode_seed(root, index))
        .collect()
}

/// How many plants each of these workers should fly abreast when plants of one worker share a simulator.
#[must_use]
pub fn abreast(episodes: usize, workers: NonZeroUsize) -> u16 {
    episodes.div_ceil(workers.get()).clamp(1, ABREAST) as u16
}

/// What a flight brought home.
#[derive(Clone, Debug, Default)]
pub struct Flight {
    /// One report per seed, in the order of the seeds.
    pub episodes: Vec<EpisodeReport>,
    /// How long the controller's ticks took, seen from this machine; it differs from run to run.
    pub tick_times: TickTimes,
    /// What the devices say of it, if it was flown on devices.
    pub device: Option<DeviceSummary>,
}

/// Why a flight ended early.
#[derive(Debug, Error)]
pub enum FlyError {
    /// The controller does not take the artefact: this machine does not compute its golden vectors.
    #[error("fly the artefact: {0}")]
    Load(#[from] ArtifactError),
    /// No plant could be had for a worker.
    #[error("make a plant ready: {0}")]
    NoPlant(#[source] PlantError),
    /// No pilot could be had for a worker.
    #[error("make a pilot ready: {0}")]
    NoPilot(#[source] RemoteError),
    /// An episode failed, and, where a fresh plant could help, failed again on one.
    #[error("fly the episode of seed {seed}: {source}")]
    Episode {
        /// The episode's seed.
        seed: u64,
        /// What the plant or the pilot said.
        source: EpisodeError,
    },
    /// Someone asked to stop.
    #[error("fly all episodes: stopped on request after {flown}")]
    Interrupted {
        /// Episodes flown by then.
        flown: usize,
    },
}

impl FlyError {
    /// How a command ends that fails with this error.
    #[must_use]
    pub fn exit_code(&self) -> ExitCode {
        match self {
            // The bytes are whole: it is this machine that computes something else.
            Self::Load(_) => ExitCode::Faulted,
            Self::NoPlant(source) => source.exit_code(),
            Self::NoPilot(source) => source.exit_code(),
            Self::Episode { source, .. } => source.exit_code(),
            Self::Interrupted { .. } => ExitCode::Interrupted,
        }
    }
}

/// Flies one episode per seed with controllers on this machine, on the plants of several workers side by side.
///
/// # Errors
/// When the artefact is refused, or has no networks in these numbers; else as [`fly_with`].
pub fn fly<P: Plant>(
    artifact: &Artifact<'_>,
    numeric: Numeric,
    make_plants: impl Fn() -> Result<Vec<P>, PlantError> + Sync,
    seeds: &[u64],
    workers: NonZeroUsize,
    stop: impl Fn() -> bool + Sync,
    landed: impl FnMut(&EpisodeReport),
) -> Result<Flight, FlyError> {
    let controller = Controller::load(artifact, numeric)?;
    let make_pilot = || Ok(controller.clone());
    fly_with(make_pilot, make_plants, seeds, workers, stop, landed)
}

/// Flies one episode per seed, on the plants of `workers` threads side by side, each plant with a pilot of its own.
///
/// `make_plants` is called once per worker for the plants that it flies abreast, and again when the link of one of them breaks in
/// mid-episode: what its plants were flying is flown again from its seed, once. `make_pilot` is called for each plant. `stop` is
/// asked between episodes; `landed` hears of each as it ends, in any order.
///
/// # Errors
/// When a pilot or a plant fails for good, or `stop` said so.
pub fn fly_with<Q: Pilot, P: Plant>(
    make_pilot: impl Fn() -> Result<Q, RemoteError> + Sync,
    make_plants: impl Fn() -> Result<Vec<P>, PlantError> + Sync,
    seeds: &[u64],
    workers: NonZeroUsize,
    stop: impl Fn() -> bool + Sync,
    mut landed: impl FnMut(&EpisodeReport),
) -> Result<Flight, FlyError> {
    let crew = Crew::new(make_pilot, make_plants, seeds, stop);
    thread::scope(|scope| {
        let (sender, receiver) = mpsc::channel();
        for _ in 0..workers.get().min(seeds.len()) {
            let (crew, sender) = (&crew, sender.clone());
            scope.spawn(move || crew.work(&sender));
        }
        drop(sender);
        let mut slots: Vec<Option<Landed>> = seeds.iter().map(|_| None).collect();
        let mut first_error = None;
        for message in receiver {
            match message {
                Ok(home) => {
                    landed(&home.report);
                    let slot = home.index;
                    slots[slot] = Some(home);
                }
                Err(error) => first_error = first_error.or(Some(error)),
            }
        }
        let home: Vec<Landed> = slots.into_iter().flatten().collect();
        match first_error {
            Some(error) => Err(error),
            None if home.len() < seeds.len() => Err(FlyError::Interrupted { flown: home.len() }),
            None => Ok(Flight::of(home)),
        }
    })
}

impl Flight {
    fn of(home: Vec<Landed>) -> Self {
        let mut flight = Self {
            device: DeviceSummary::of(home.iter().filter_map(|landed| landed.debrief.clone())),
            ..Self::default()
        };
        for landed in home {
            flight.episodes.push(landed.report);
            flight.tick_times.append(landed.times);
        }
        flight
    }
}
