//! What the types of a configuration cannot say: which numbers a run could not come to an end with.

use crate::algorithm::AlgorithmConfig;
use crate::iql::IqlConfig;
use crate::reward::RewardConfig;
use crate::reward::oprl::{InputScaling, OprlConfig};
use crate::ted::DiscountConfig;

use super::ranges::{adam, as_written, at_least_one, positive, small, widths, within};
use super::{Config, ConfigError, Schedule};

impl Config {
    /// Checks what the types cannot say.
    ///
    /// # Errors
    /// Names the first field that is out of range, its value and the range.
    pub fn check(&self) -> Result<(), ConfigError> {
        discount(&self.discount)?;
        algorithm(&self.algorithm)?;
        if let RewardConfig::Oprl(config) = &self.reward {
            oprl(config)?;
        }
        let Schedule {
            log_every,
            checkpoint_every,
            ..
        } = self.schedule;
        at_least_one("schedule.log_every", log_every as f64)?;
        at_least_one("schedule.checkpoint_every", checkpoint_every as f64)
    }
}

fn discount(config: &DiscountConfig) -> Result<(), ConfigError> {
    let share = |field, value: f32| {
        let value = as_written(value);
        within(field, value, (0.0..=1.0).contains(&value), "in [0, 1]")
    };
    let percent = |k| within("discount.k", k, (0.0..=100.0).contains(&k), "in [0, 100]");
    match *config {
        DiscountConfig::Constant { gamma } => share("discount.gamma", gamma),
        DiscountConfig::Ted { gamma, k, sigma }
        | DiscountConfig::TedTransition { gamma, k, sigma } => {
            share("discount.gamma", gamma)?;
            share("discount.sigma", sigma)?;
            percent(k)
        }
        DiscountConfig::TedSoft { gamma, sigma } => {
            share("discount.gamma", gamma)?;
            share("discount.sigma", sigma)
        }
        DiscountConfig::RewardPenalty { gamma, k, penalty } => {
            share("discount.gamma", gamma)?;
            let holds = penalty >= 0.0 && penalty.is_finite();
            let value = as_written(penalty);
            within("discount.penalty", value, holds, "in [0, inf)")?;
            percent(k)
        }
    }
}

fn algorithm(config: &AlgorithmConfig) -> Result<(), ConfigError> {
    match config {
        AlgorithmConfig::Iql(config) => iql(config),
    }
}

fn iql(config: &IqlConfig) -> Result<(), ConfigError> {
    let IqlConfig { tau, beta, .. } = *config;
    within("algorithm.tau", tau, tau > 0.0 && tau < 1.0, "in (0, 1)")?;
    let holds = beta >= 0.0 && beta.is_finite();
    within("algorithm.beta", beta, holds, "in [0, inf)")?;
    at_least_one("algorithm.steps", config.steps as f64)?;
    at_least_one("algorithm.batch", config.batch as f64)?;
    let rate = config.target_rate;
    let holds = rate > 0.0 && rate <= 1.0;
    within("algorithm.target_rate", rate, holds, "in (0, 1]")?;
    positive("algorithm.learning_rate", config.learning_rate)?;
    positive("algorithm.advantage_clip", config.advantage_clip)?;
    let [low, high] = config.log_std;
    within(
        "algorithm.log_std[1]",
        high,
        high.is_finite(),
        "in (-inf, inf)",
    )?;
    let holds = low.is_finite() && low <= high;
    within(
        "algorithm.log_std[0]",
        low,
        holds,
        "in (-inf, algorithm.log_std[1]]",
    )?;
    let fields = [
        "algorithm.adam.beta1",
        "algorithm.adam.beta2",
        "algorithm.adam.epsilon",
    ];
    adam(fields, config.adam)?;
    widths("algorithm.hidden", &config.hidden)
}

fn oprl(config: &OprlConfig) -> Result<(), ConfigError> {
    let members = config.members;
    let holds = (1..=ted_core::MAX_MEMBERS).contains(&members);
    within("reward.members", members as f64, holds, "1 to 8")?;
    at_least_one("reward.segment", config.segment.into())?;
    at_least_one("reward.pool", config.pool as f64)?;
    positive("reward.learning_rate", config.learning_rate)?;
    if let InputScaling::Standard { floor } = config.scaling {
        // A channel that never moves is divided by the floor.
        small("reward.scaling.floor", as_written(floor))?;
    }
    let fields = [
        "reward.adam.beta1",
        "reward.adam.beta2",
        "reward.adam.epsilon",
    ];
    adam(fields, config.adam)?;
    widths("reward.hidden", &config.hidden)
}
