//! The whole configuration of a run as one typed value: read from presets, files and `--set`, checked once, written out
//! resolved beside every result.

mod check;
mod error;
mod overrides;
mod preset;
mod ranges;

pub use error::ConfigError;
pub use overrides::Overrides;
pub use preset::{Preset, Row, TABLE};

use serde::{Deserialize, Serialize};

use crate::algorithm::{AlgorithmConfig, ObservationScaling};
use crate::filter::FilterConfig;
use crate::nn::Backend;
use crate::preferences::{ScriptedTeacher, TeacherConfig};
use crate::reward::{RewardConfig, RewardLearner};
use crate::rng::Seed;
use crate::ted::DiscountConfig;

/// Everything that decides what a run computes. The run's folder and the number of threads are not part of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Config {
    /// The composition that the configuration started from.
    pub preset: Preset,
    /// Root of all randomness.
    pub seed: u64,
    /// What trains: an engine on this machine's processor, or its GPU.
    pub backend: Backend,
    /// Whether rewards are mapped to [0, 1] over the dataset before discounts are lowered.
    pub unit_rewards: bool,
    /// How the offline algorithm and its policy see observations.
    #[serde(default)]
    pub observations: ObservationScaling,
    /// Where rewards come from.
    pub reward: RewardConfig,
    /// Which episodes the policy is learned from.
    pub filter: FilterConfig,
    /// Which discount a transition gets.
    pub discount: DiscountConfig,
    /// Which offline algorithm learns the policy, and how.
    pub algorithm: AlgorithmConfig,
    /// How often the run is evaluated, logged and saved.
    pub schedule: Schedule,
    /// Who answers, where no log does.
    #[serde(default, skip_serializing_if = "TeacherConfig::is_default")]
    pub teacher: TeacherConfig,
}

/// What happens how often during the offline phase.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Schedule {
    /// Updates between two rows of metrics.
    pub log_every: u64,
    /// Updates between two checkpoints.
    pub checkpoint_every: u64,
    /// Episodes flown with the final policy; 0 to leave evaluation to `ted eval`.
    pub evaluation_episodes: u32,
}

impl Default for Schedule {
    fn default() -> Self {
        Self {
            log_every: 500,
            checkpoint_every: 5_000,
            evaluation_episodes: 50,
        }
    }
}

impl Config {
    /// The resolved configuration as TOML, in one canonical form.
    ///
    /// # Panics
    /// Never: every field of a configuration can be written as TOML.
    #[must_use]
    pub fn to_toml(&self) -> String {
        toml::to_string_pretty(self).expect("a configuration is plain data")
    }

    /// Whether somebody has to answer questions.
    #[must_use]
    pub fn asks(&self) -> bool {
        self.reward.learner().is_some() || self.algorithm.questions().is_some()
    }

    /// Who answers, where no log does.
    #[must_use]
    pub fn simulated_teacher(&self) -> ScriptedTeacher {
        ScriptedTeacher::new(self.teacher, Seed::root(self.seed).child("teacher"))
    }

    /// How many answers are asked for.
    #[must_use]
    pub fn answers(&self) -> usize {
        let of_rewards = self.reward.learner().map_or(0, RewardLearner::queries);
        let of_policy = self.algorithm.questions().map_or(0, |it| it.queries);
        of_rewards + of_policy
    }

    /// The same with so many answers. The questions before a number are the same, whichever number it is.
    #[must_use]
    pub fn asking(&self, answers: usize) -> Self {
        let learns = self.reward.learner().is_some();
        let (reward, algorithm) = match learns {
            true => (self.reward.asking(answers), self.algorithm.clone()),
            false => (self.reward.clone(), self.algorithm.asking(answers)),
        };
        Self {
            reward,
            algorithm,
            ..self.clone()
        }
    }

    /// Digest of the canonical form, which travels in the artefact.
    #[must_use]
    pub fn digest(&self) -> [u8; 32] {
        *blake3::hash(self.to_toml().as_bytes()).as_bytes()
    }
}
