//! The whole configuration of a run as one typed value: read from presets, files and `--set`, checked once, written out
//! resolved beside every result.

mod error;
mod overrides;
mod preset;

pub use error::ConfigError;
pub use overrides::Overrides;
pub use preset::Preset;

use serde::{Deserialize, Serialize};

use crate::iql::IqlConfig;
use crate::nn::Backend;
use crate::reward::RewardConfig;
use crate::ted::DiscountConfig;

/// Everything that decides what a run computes. The run's folder and the number of threads are not part of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Config {
    /// The composition that the configuration started from.
    pub preset: Preset,
    /// Root of all randomness.
    pub seed: u64,
    /// Which burn CPU backend trains.
    pub backend: Backend,
    /// Whether rewards are mapped to [0, 1] over the dataset before discounts are lowered.
    pub unit_rewards: bool,
    /// Where rewards come from.
    pub reward: RewardConfig,
    /// Which discount a transition gets.
    pub discount: DiscountConfig,
    /// Which offline algorithm learns the policy, and how.
    pub iql: IqlConfig,
    /// How often the run is evaluated, logged and saved.
    pub schedule: Schedule,
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

    /// Digest of the canonical form, which travels in the artefact.
    #[must_use]
    pub fn digest(&self) -> [u8; 32] {
        *blake3::hash(self.to_toml().as_bytes()).as_bytes()
    }

    /// Checks what the types cannot say.
    ///
    /// # Errors
    /// Names the first field that is out of range, its value and the range.
    pub fn check(&self) -> Result<(), ConfigError> {
        let within = |field: &'static str, value: f64, holds: bool, range: &'static str| {
            if holds {
                Ok(())
            } else {
                Err(ConfigError::OutOfRange {
                    field,
                    value,
                    range,
                })
            }
        };
        let closed =
            |field, value: f64| within(field, value, (0.0..=1.0).contains(&value), "[0, 1]");
        match self.discount {
            DiscountConfig::Constant { gamma } => closed("discount.gamma", as_written(gamma))?,
            DiscountConfig::Ted { gamma, k, sigma } => {
                closed("discount.gamma", as_written(gamma))?;
                closed("discount.sigma", as_written(sigma))?;
                within("discount.k", k, (0.0..=100.0).contains(&k), "[0, 100]")?;
            }
        }
        let iql = &self.iql;
        within("iql.tau", iql.tau, iql.tau > 0.0 && iql.tau < 1.0, "(0, 1)")?;
        within(
            "iql.beta",
            iql.beta,
            iql.beta >= 0.0 && iql.beta.is_finite(),
            "[0, inf)",
        )?;
        within("iql.steps", iql.steps as f64, iql.steps > 0, "at least 1")?;
        within("iql.batch", iql.batch as f64, iql.batch > 0, "at least 1")?;
        within(
            "iql.target_rate",
            iql.target_rate,
            iql.target_rate > 0.0 && iql.target_rate <= 1.0,
            "(0, 1]",
        )?;
        within(
            "iql.learning_rate",
            iql.learning_rate,
            iql.learning_rate > 0.0,
            "(0, inf)",
        )?;
        within(
            "iql.advantage_clip",
            iql.advantage_clip,
            iql.advantage_clip > 0.0,
            "(0, inf)",
        )?;
        widths("iql.hidden", &iql.hidden)?;
        if let RewardConfig::Oprl(oprl) = &self.reward {
            let members = oprl.members as f64;
            within(
                "reward.members",
                members,
                (1..=ted_core::MAX_MEMBERS).contains(&oprl.members),
                "1 to 8",
            )?;
            within(
                "reward.segment",
                oprl.segment.into(),
                oprl.segment > 0,
                "at least 1",
            )?;
            within("reward.pool", oprl.pool as f64, oprl.pool > 0, "at least 1")?;
            within(
                "reward.learning_rate",
                oprl.learning_rate,
                oprl.learning_rate > 0.0,
                "(0, inf)",
            )?;
            widths("reward.hidden", &oprl.hidden)?;
        }
        within(
            "schedule.log_every",
            self.schedule.log_every as f64,
            self.schedule.log_every > 0,
            "at least 1",
        )?;
        let every = self.schedule.checkpoint_every;
        within(
            "schedule.checkpoint_every",
            every as f64,
            every > 0,
            "at least 1",
        )
    }
}

/// The double with the digits of a single: 1.01 stays 1.01 in a message.
fn as_written(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(value.into())
}

/// The controller's core has room for this many layers of this width.
fn widths(field: &'static str, hidden: &[usize]) -> Result<(), ConfigError> {
    let fits = hidden.iter().all(|w| (1..=ted_core::MAX_WIDTH).contains(w))
        && hidden.len() < ted_core::MAX_LAYERS;
    if fits {
        Ok(())
    } else {
        Err(ConfigError::Widths {
            field,
            hidden: hidden.to_vec(),
        })
    }
}
