//! The worlds that policies are flown in: what the rest of the code knows of a simulator. A new one is a folder of its own here, and a
//! line of [`LISTED`].

pub mod d4rl;
pub mod metaworld;
mod names;
mod own;
mod toy;

use std::fmt;

pub use names::{TaskError, resolve, single};
pub use own::OwnWorld;

use crate::bridge::environment::{self, Program, SetupError};
use crate::bridge::{Engine, Environment};
use crate::plant::{Plant, PlantError};
use crate::plants::simulated::SimulatedPlant;
use crate::progress::Audience;
use crate::robot::Robot;
use crate::rollout::normalised_score;

/// The worlds that this program knows.
pub const LISTED: [&dyn Kind; 3] = [&metaworld::MetaWorld, &d4rl::D4rl, &toy::Toy];

/// A world that this program knows.
pub trait Kind: Sync {
    /// Its name.
    fn name(&self) -> &'static str;

    /// What it is, in a line.
    fn about(&self) -> &'static str;

    /// What can be done there.
    fn tasks(&self) -> Vec<&'static str>;

    /// Names that stand for several of its tasks.
    fn groups(&self) -> &'static [(&'static str, &'static [&'static str])] {
        &[]
    }

    /// The robot of a task.
    fn robot(&self, task: &'static str) -> Robot;

    /// What simulates a task.
    fn simulation(&self, task: &'static str, engine: Engine) -> Simulation;

    /// Whether there is a choice of engines.
    fn has_engines(&self) -> bool {
        false
    }

    /// Whether it draws the states that its logs hold.
    fn draws(&self) -> bool {
        false
    }

    /// How the scripted policy records logs; none where there is no such policy.
    fn collection(&self, _task: &'static str) -> Option<Collection> {
        None
    }

    /// The returns that a score of 0 and of 1 stand for, where they are the same for all logs of a task. Elsewhere they are a return
    /// of 0 and the largest return of the logs.
    fn yardstick(&self, _task: &'static str) -> Option<[f64; 2]> {
        None
    }
}

/// What simulates a task.
pub enum Simulation {
    /// This process: one plant, as often as it is asked for.
    Here(AnyPlant),
    /// A worker in the simulator's environment.
    Worker(Program),
}

/// How a scripted policy records logs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collection {
    /// Steps of an episode.
    pub steps: u32,
    /// What a task of two intentions shares with the other one; none for a task with one.
    pub scene: Option<&'static str>,
    /// The version of its reward, which the dataset names.
    pub reward: &'static str,
    /// What biased logs add to every action; none where actions can neither be pushed nor drift.
    pub push: Option<[f64; 4]>,
    /// Numbers at most that are recorded of a step beside what a policy is learned from: the state of the simulator.
    pub infos: usize,
}

/// A task of a world that this program knows.
#[derive(Clone, Copy)]
pub struct Task {
    kind: &'static dyn Kind,
    name: &'static str,
}

impl Task {
    /// Its name, which no task of another world has.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        self.name
    }

    /// Its world.
    #[must_use]
    pub const fn kind(&self) -> &'static dyn Kind {
        self.kind
    }

    /// Its robot.
    #[must_use]
    pub fn robot(&self) -> Robot {
        self.kind.robot(self.name)
    }

    /// How its scripted policy records logs, if there is one.
    #[must_use]
    pub fn collection(&self) -> Option<Collection> {
        self.kind.collection(self.name)
    }

    /// The score of a mean return here, for a policy that was trained for a task whose logs reached `largest_return` at best. None
    /// where the logs are the measure, and they are another task's or never reached more than 0.
    #[must_use]
    pub fn score(&self, return_mean: f64, largest_return: f64, trained_for: &str) -> Option<f64> {
        match self.kind.yardstick(self.name) {
            Some([zero, one]) => Some((return_mean - zero) / (one - zero)),
            None if trained_for == self.name => normalised_score(return_mean, largest_return),
            None => None,
        }
    }
}

impl PartialEq for Task {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for Task {}

impl fmt::Debug for Task {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} of {}", self.name, self.kind.name())
    }
}

/// A world and what is done there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum World {
    /// A task of a world that this program knows.
    Listed(Task),
    /// What a person brings.
    Own(OwnWorld),
}

impl World {
    /// The world of a task.
    ///
    /// # Errors
    /// When the task is of no world.
    pub fn of_task(task: &str) -> Result<Self, TaskError> {
        single(task).map(Self::Listed)
    }

    /// What is done there.
    #[must_use]
    pub fn task(&self) -> String {
        match self {
            Self::Listed(task) => task.name().to_owned(),
            Self::Own(own) => own.to_string(),
        }
    }

    /// Which world it is.
    #[must_use]
    pub fn name(&self) -> String {
        match self {
            Self::Listed(task) => task.kind().name().to_owned(),
            Self::Own(own) => own.to_string(),
        }
    }

    /// The returns that a score of 0 and of 1 stand for, where they are the same for all logs.
    #[must_use]
    pub fn yardstick(&self) -> Option<[f64; 2]> {
        match self {
            Self::Listed(task) => task.kind.yardstick(task.name),
            Self::Own(_) => None,
        }
    }

    /// Whether there is a choice of engines.
    #[must_use]
    pub fn has_engines(&self) -> bool {
        matches!(self, Self::Listed(task) if task.kind.has_engines())
    }

    /// The score of a mean return here, as [`Task::score`] has it; none in a world of one's own, whose rewards nobody knows to be those
    /// of the logs.
    #[must_use]
    pub fn score(&self, return_mean: f64, largest_return: f64, trained_for: &str) -> Option<f64> {
        match self {
            Self::Listed(task) => task.score(return_mean, largest_return, trained_for),
            Self::Own(_) => None,
        }
    }

    /// The world with its simulator, installed first if need be.
    ///
    /// # Errors
    /// When there is no simulator and none can be installed.
    pub fn ready(self, engine: Engine, audience: Audience) -> Result<Ready, SetupError> {
        let ready = self.ready_in(engine, || environment::ensure(audience).map(Some))?;
        Ok(ready.expect("what is ensured is there"))
    }

    /// The same where nothing is to be installed: none if the simulator is not there.
    ///
    /// # Errors
    /// When the simulator's files cannot be written.
    pub fn ready_if_installed(self, engine: Engine) -> Result<Option<Ready>, SetupError> {
        self.ready_in(engine, environment::find)
    }

    fn ready_in(
        self,
        engine: Engine,
        simulator: impl FnOnce() -> Result<Option<Environment>, SetupError>,
    ) -> Result<Option<Ready>, SetupError> {
        let simulator = match &self {
            Self::Own(own) => Some(own.environment()?),
            Self::Listed(task) => match task.kind.simulation(task.name, engine) {
                Simulation::Here(_) => None,
                Simulation::Worker(program) => match simulator()? {
                    Some(environment) => Some(environment.running(program)?),
                    None => return Ok(None),
                },
            },
        };
        Ok(Some(Ready {
            world: self,
            engine,
            simulator,
        }))
    }
}

/// A world that can be flown in.
#[derive(Clone, Debug)]
pub struct Ready {
    world: World,
    engine: Engine,
    simulator: Option<Environment>,
}

impl Ready {
    /// Which it is.
    #[must_use]
    pub const fn world(&self) -> &World {
        &self.world
    }

    /// The engine, if there is a choice of them.
    #[must_use]
    pub fn engine(&self) -> Option<Engine> {
        self.world.has_engines().then_some(self.engine)
    }

    /// The simulator; none for a world that is simulated in this process.
    #[must_use]
    pub const fn simulator(&self) -> Option<&Environment> {
        self.simulator.as_ref()
    }

    /// Plants that fly side by side, `abreast` of them where they share a simulator. A step takes `period_us` of simulated time where
    /// the world does not say otherwise.
    ///
    /// # Errors
    /// When the simulator does not start.
    pub fn plants(&self, abreast: u16, period_us: u32) -> Result<Vec<AnyPlant>, PlantError> {
        let period_us = match self.world {
            World::Listed(task) => {
                if let Simulation::Here(plant) = task.kind.simulation(task.name, self.engine) {
                    return Ok(vec![plant]);
                }
                task.robot().period_us
            }
            World::Own(_) => period_us,
        };
        let simulator = self.simulator.as_ref().ok_or(PlantError::NoEpisode)?;
        let task = self.world.task();
        let plants = SimulatedPlant::several(simulator, &task, period_us, abreast);
        let plants = plants.map_err(PlantError::link)?.into_iter();
        Ok(plants.map(|plant| Box::new(plant) as AnyPlant).collect())
    }
}

/// A plant of any world.
pub type AnyPlant = Box<dyn Plant>;

/// The robot of a task; none where the task is of no world.
#[must_use]
pub fn robot_of(task: &str) -> Option<Robot> {
    single(task).ok().map(|task| task.robot())
}
