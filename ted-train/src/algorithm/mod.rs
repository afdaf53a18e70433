//! The choice of an offline algorithm: from a labelled dataset to a policy.

pub mod atac;
pub mod awr;
mod batch;
pub mod bc;
pub mod conditioned;
mod conditions;
#[cfg(test)]
pub(crate) mod fixtures;
pub mod iql;
mod learner;
pub mod oppo;
mod replay;
mod transitions;

pub use batch::Batch;
pub use conditions::Conditions;
pub(crate) use learner::metrics;
pub use learner::{Learner, Losses, Metrics, Policy};
pub use replay::{ObservationScaling, Replay};

use serde::{Deserialize, Serialize};

use self::atac::{Atac, AtacConfig};
use self::awr::{Awr, AwrConfig};
use self::bc::{Bc, BcConfig};
use self::conditioned::{Conditioned, ConditionedConfig};
use self::iql::{Iql, IqlConfig};
use self::oppo::{Oppo, OppoConfig};
use self::transitions::OfTransitions;
use crate::dataset::{Clip, Dataset};
use crate::filter::Kept;
use crate::nn::Backend;
use crate::reward::RandomQueries;
use crate::rng::Seed;

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
    /// Behaviour cloning conditioned on the predicted return of an episode, flown at the best.
    Conditioned(ConditionedConfig),
    /// A policy for sequences, learned from answers without a reward.
    Oppo(OppoConfig),
}

impl AlgorithmConfig {
    /// As the configuration calls it; also the name of its metrics and of its random streams.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Iql(_) => "iql",
            Self::Atac(_) => "atac",
            Self::Awr(_) => "awr",
            Self::Bc(_) => "bc",
            Self::Conditioned(_) => "conditioned",
            Self::Oppo(_) => "oppo",
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
            Self::Conditioned(config) => config.steps,
            Self::Oppo(config) => config.steps,
        }
    }

    /// The same algorithm with another number of gradient steps.
    pub fn set_steps(&mut self, steps: u64) {
        match self {
            Self::Iql(config) => config.steps = steps,
            Self::Atac(config) => config.steps = steps,
            Self::Awr(config) => config.steps = steps,
            Self::Bc(config) => config.steps = steps,
            Self::Conditioned(config) => config.steps = steps,
            Self::Oppo(config) => config.steps = steps,
        }
    }

    /// Transitions in a batch, or clips of the dataset.
    #[must_use]
    pub fn batch(&self) -> usize {
        match self {
            Self::Iql(config) => config.batch,
            Self::Atac(config) => config.batch,
            Self::Awr(config) => config.batch,
            Self::Bc(config) => config.batch,
            Self::Conditioned(config) => config.batch,
            Self::Oppo(config) => config.batch,
        }
    }

    /// What somebody is asked for it, where the policy itself is learned from answers.
    #[must_use]
    pub fn questions(&self) -> Option<RandomQueries> {
        match self {
            Self::Oppo(config) => Some(RandomQueries {
                queries: config.queries,
                clip: Clip::Steps(config.segment),
            }),
            Self::Iql(_) | Self::Atac(_) | Self::Awr(_) | Self::Bc(_) | Self::Conditioned(_) => {
                None
            }
        }
    }

    /// The same with so many answers, where the policy itself is learned from answers.
    #[must_use]
    pub fn asking(&self, answers: usize) -> Self {
        match self {
            Self::Oppo(config) => Self::Oppo(OppoConfig {
                queries: answers,
                ..config.clone()
            }),
            Self::Iql(_) | Self::Atac(_) | Self::Awr(_) | Self::Bc(_) | Self::Conditioned(_) => {
                self.clone()
            }
        }
    }

    /// Whether it looks at rewards, one by one or summed over episodes.
    #[must_use]
    pub fn reads_rewards(&self) -> bool {
        match self {
            Self::Iql(_) | Self::Atac(_) | Self::Awr(_) | Self::Conditioned(_) => true,
            Self::Bc(_) | Self::Oppo(_) => false,
        }
    }

    /// Whether it looks at the discount of each transition.
    #[must_use]
    pub fn reads_discounts(&self) -> bool {
        match self {
            Self::Iql(_) | Self::Atac(_) | Self::Awr(_) => true,
            Self::Bc(_) | Self::Conditioned(_) | Self::Oppo(_) => false,
        }
    }

    /// How good each episode is, where the policy is told; `quality` has of every episode how good it is predicted to be.
    #[must_use]
    pub fn conditions(
        &self,
        dataset: &Dataset,
        kept: &Kept,
        quality: &[f32],
    ) -> Option<Conditions> {
        match self {
            Self::Conditioned(config) => Some(Conditions::new(dataset, kept, quality, config.best)),
            _ => None,
        }
    }

    /// Whether its policy is a network that a controller flies.
    #[must_use]
    pub fn makes_networks(&self) -> bool {
        !matches!(self, Self::Oppo(_))
    }

    /// A fresh learner with a lane for each of these datasets, all of one shape, and root seeds.
    ///
    /// # Panics
    /// When a dataset has no clip as long as OPPO looks at, which [`crate::train::check`] refuses.
    #[must_use]
    pub fn learner(
        &self,
        lanes: &[&Replay<'_>],
        roots: &[Seed],
        backend: Backend,
    ) -> Box<dyn Learner> {
        let dims = |lane: &&Replay<'_>| {
            (
                lane.dataset().observation_dim(),
                lane.dataset().action_dim(),
            )
        };
        let (observation, action) = lanes.first().map_or((0, 0), dims);
        let of_roots = |name: &str| {
            roots
                .iter()
                .map(|root| root.child(name))
                .collect::<Vec<_>>()
        };
        let seeds = of_roots(self.name());
        let (streams, batch) = (of_roots(&format!("{}/batch", self.name())), self.batch());
        match self {
            Self::Iql(config) => {
                let learner = Iql::new(config.clone(), observation, action, &seeds, backend);
                Box::new(OfTransitions::new(learner, streams, batch))
            }
            Self::Atac(config) => {
                let learner = Atac::new(config.clone(), observation, action, &seeds, backend);
                Box::new(OfTransitions::new(learner, streams, batch))
            }
            Self::Awr(config) => {
                let learner = Awr::new(config.clone(), observation, action, &seeds, backend);
                Box::new(OfTransitions::new(learner, streams, batch))
            }
            Self::Bc(config) => {
                let learner = Bc::new(config.clone(), observation, action, &seeds, backend);
                Box::new(OfTransitions::new(learner, streams, batch))
            }
            Self::Conditioned(config) => {
                let advances: Vec<_> = lanes.iter().map(|lane| lane.advance()).collect();
                let learner =
                    Conditioned::new(config.clone(), observation, action, &seeds, backend);
                Box::new(OfTransitions::new(
                    learner.flown_at(&advances),
                    streams,
                    batch,
                ))
            }
            Self::Oppo(config) => {
                let lanes = lanes.iter().zip(seeds);
                let learner = |(lane, seed): (&&Replay<'_>, Seed)| {
                    let oppo = Oppo::new(config, lane.dataset(), seed, backend);
                    oppo.expect("the dataset was checked")
                };
                Box::new(lanes.map(learner).collect::<Vec<_>>())
            }
        }
    }
}
