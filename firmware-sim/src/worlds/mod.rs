//! The worlds that policies are flown in: what the rest of the code knows of a simulator. A new one is a variant here and a folder
//! of its own.

pub mod metaworld;
mod own;

pub use own::OwnWorld;

use crate::bridge::environment::{self, SetupError};
use crate::bridge::{Engine, Environment};
use crate::plant::{Plant, PlantError};
use crate::plants::simulated::SimulatedPlant;
use crate::plants::toy::{ToyPlant, Units};
use crate::progress::Audience;
use crate::robot::Robot;
use crate::tasks::{self, TaskError};

/// A world and what is done there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum World {
    /// The toy, which needs no Python.
    Toy(Units),
    /// A task of MuJoCo Meta-World.
    MetaWorld(&'static str),
    /// What a person brings.
    Own(OwnWorld),
}

impl World {
    /// The world of a task.
    ///
    /// # Errors
    /// When the task is of no world.
    pub fn of_task(task: &str) -> Result<Self, TaskError> {
        match Units::of_task(task) {
            Some(units) => Ok(Self::Toy(units)),
            None => tasks::single(task).map(Self::MetaWorld),
        }
    }

    /// What is done there.
    #[must_use]
    pub fn task(&self) -> String {
        match self {
            Self::Toy(units) => units.task().to_owned(),
            Self::MetaWorld(task) => (*task).to_owned(),
            Self::Own(own) => own.to_string(),
        }
    }

    /// The world with its simulator, installed first if need be.
    ///
    /// # Errors
    /// When there is no simulator and none can be installed.
    pub fn ready(self, engine: Engine, audience: Audience) -> Result<Ready, SetupError> {
        let simulator = match &self {
            Self::Toy(_) => None,
            Self::MetaWorld(_) => Some(environment::ensure(audience)?.with_engine(engine)),
            Self::Own(own) => Some(own.environment()?),
        };
        Ok(Ready {
            world: self,
            simulator,
        })
    }

    /// The same where nothing is to be installed: none if the simulator is not there.
    ///
    /// # Errors
    /// When the simulator's files cannot be written.
    pub fn ready_if_installed(self, engine: Engine) -> Result<Option<Ready>, SetupError> {
        let simulator = match &self {
            Self::Toy(_) => None,
            Self::MetaWorld(_) => match environment::find()? {
                Some(found) => Some(found.with_engine(engine)),
                None => return Ok(None),
            },
            Self::Own(own) => Some(own.environment()?),
        };
        Ok(Some(Ready {
            world: self,
            simulator,
        }))
    }
}

/// A world that can be flown in.
#[derive(Clone, Debug)]
pub struct Ready {
    world: World,
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
        match self.world {
            World::MetaWorld(_) => self.simulator.as_ref().map(Environment::engine),
            World::Toy(_) | World::Own(_) => None,
        }
    }

    /// Plants that fly side by side, `abreast` of them where they share a simulator. A step takes `period_us` of simulated time where
    /// the world does not say otherwise.
    ///
    /// # Errors
    /// When the simulator does not start.
    pub fn plants(&self, abreast: u16, period_us: u32) -> Result<Vec<AnyPlant>, PlantError> {
        let Some(simulator) = &self.simulator else {
            let units = match self.world {
                World::Toy(units) => units,
                World::MetaWorld(_) | World::Own(_) => Units::default(),
            };
            return Ok(vec![Box::new(ToyPlant::in_units(units))]);
        };
        let period_us = match self.world {
            World::MetaWorld(_) => metaworld::robot().period_us,
            World::Toy(_) | World::Own(_) => period_us,
        };
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
    match World::of_task(task).ok()? {
        World::Toy(units) => Some(units.robot()),
        World::MetaWorld(_) => Some(metaworld::robot()),
        World::Own(_) => None,
    }
}
