//! The choice of an offline algorithm, and what all of them have in common: from batches of labelled transitions to a policy.

pub mod atac;
pub mod awr;
mod batch;
pub mod bc;
#[cfg(test)]
pub(crate) mod fixtures;
pub mod iql;
mod replay;

pub use batch::Batch;
pub use replay::Replay;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use self::atac::{Atac, AtacConfig};
use self::awr::{Awr, AwrConfig};
use self::bc::{Bc, BcConfig};
use self::iql::{Iql, IqlConfig};
use crate::nn::{Backend, ExportedMlp};
use crate::rng::Seed;
use crate::run::{Checkpoint, ForeignCheckpoint};

/// Which offline algorithm learns the policy, with all of its numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum AlgorithmConfig {
    /// Implicit Q-learning.
    Iql(IqlConfig),
    /// Adversarially trained actor critic.
    Atac(AtacConfig),
    /// Advantage-weighted regression.
    Awr(AwrConfig),
    /// Behaviour cloning.
    Bc(BcConfig),
}

/// A learner of one policy for each of its lanes, which make every update together and share nothing.
pub trait Learner: Send {
    /// Updates made so far, the same number in every lane.
    fn step(&self) -> u64;

    /// Looks at whole datasets, one for each lane, where the next update needs more than its batch.
    fn prepare(&mut self, replays: &[&Replay<'_>]) {
        let _ = replays;
    }

    /// One update, on a batch of every lane, lane after lane.
    fn update(&mut self, batch: &Batch) -> Box<dyn Losses>;

    /// Everything that the next update of a lane depends on: the same whatever lanes are beside it.
    fn checkpoint(&self, lane: usize, config_digest: [u8; 32]) -> Checkpoint;

    /// Puts saved states in the place of this one: a checkpoint of each lane, all after the same update.
    ///
    /// # Errors
    /// When they are not, or one lacks a tensor or has another shape; the learner must not be used then.
    fn restore(&mut self, lanes: &[&Checkpoint]) -> Result<(), ForeignCheckpoint>;

    /// The policy of each lane in the controller's layout: its mean action.
    fn actors(&self) -> Vec<ExportedMlp>;
}

/// What an update saw, still on the device.
pub trait Losses {
    /// Fetches the numbers of each lane, by name. One that is not finite is null.
    fn read(self: Box<Self>) -> Vec<Metrics>;
}

/// Numbers of an update by name; those called `…_loss` are what it minimised.
pub type Metrics = Map<String, Value>;

impl AlgorithmConfig {
    /// As the configuration calls it; also the name of its metrics and of its random streams.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Iql(_) => "iql",
            Self::Atac(_) => "atac",
            Self::Awr(_) => "awr",
            Self::Bc(_) => "bc",
        }
    }

    /// Gradient steps of a whole run.
    #[must_use]
    pub fn steps(&self) -> u64 {
        match self {
            Self::Iql(config) => config.steps,
            Self::Atac(config) => config.steps,
            Self::Awr(config) => config.steps,
            Self::Bc(config) => config.steps,
        }
    }

    /// The same algorithm with another number of gradient steps.
    pub fn set_steps(&mut self, steps: u64) {
        match self {
            Self::Iql(config) => config.steps = steps,
            Self::Atac(config) => config.steps = steps,
            Self::Awr(config) => config.steps = steps,
            Self::Bc(config) => config.steps = steps,
        }
    }

    /// Transitions in a batch.
    #[must_use]
    pub fn batch(&self) -> usize {
        match self {
            Self::Iql(config) => config.batch,
            Self::Atac(config) => config.batch,
            Self::Awr(config) => config.batch,
            Self::Bc(config) => config.batch,
        }
    }

    /// A fresh learner with a lane for the run of each root seed.
    #[must_use]
    pub fn learner(
        &self,
        observation: usize,
        action: usize,
        roots: &[Seed],
        backend: Backend,
    ) -> Box<dyn Learner> {
        let seeds: Vec<_> = roots.iter().map(|root| root.child(self.name())).collect();
        match self {
            Self::Iql(config) => {
                let config = config.clone();
                Box::new(Iql::new(config, observation, action, &seeds, backend))
            }
            Self::Atac(config) => {
                let config = config.clone();
                Box::new(Atac::new(config, observation, action, &seeds, backend))
            }
            Self::Awr(config) => {
                let config = config.clone();
                Box::new(Awr::new(config, observation, action, &seeds, backend))
            }
            Self::Bc(config) => {
                let config = config.clone();
                Box::new(Bc::new(config, observation, action, &seeds, backend))
            }
        }
    }

    /// Where the batches of a run are drawn from.
    #[must_use]
    pub fn stream(&self, root: Seed) -> Seed {
        root.child(&format!("{}/batch", self.name()))
    }
}

/// Makes a learner of a type that has all of a learner's methods.
macro_rules! learner {
    ($learner:ty, $losses:ty $(, $prepare:ident)?) => {
        impl Learner for $learner {
            fn step(&self) -> u64 {
                self.step()
            }

            $(fn $prepare(&mut self, replays: &[&Replay<'_>]) {
                self.$prepare(replays);
            })?

            fn update(&mut self, batch: &Batch) -> Box<dyn Losses> {
                Box::new(self.update(batch))
            }

            fn checkpoint(&self, lane: usize, config_digest: [u8; 32]) -> Checkpoint {
                self.checkpoint(lane, config_digest)
            }

            fn restore(&mut self, lanes: &[&Checkpoint]) -> Result<(), ForeignCheckpoint> {
                self.restore(lanes)
            }

            fn actors(&self) -> Vec<ExportedMlp> {
                self.actors()
            }
        }

        impl Losses for $losses {
            fn read(self: Box<Self>) -> Vec<Metrics> {
                (*self).read().iter().map(metrics).collect()
            }
        }
    };
}

learner!(Iql, self::iql::Losses);
learner!(Atac, self::atac::Losses);
learner!(Awr, self::awr::Losses, prepare);
learner!(Bc, self::bc::Losses);

fn metrics(update: &impl Serialize) -> Metrics {
    match serde_json::to_value(update) {
        Ok(Value::Object(metrics)) => metrics,
        _ => unreachable!("metrics are plain data"),
    }
}
