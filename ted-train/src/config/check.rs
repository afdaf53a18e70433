//! What the types of a configuration cannot say: which numbers a run could not come to an end with.

use crate::iql::IqlConfig;
use crate::nn::Adam;
use crate::reward::RewardConfig;
use crate::reward::oprl::{InputScaling, OprlConfig};
use crate::ted::DiscountConfig;

use super::{Config, ConfigError, Schedule};

impl Config {
    /// Checks what the types cannot say.
    ///
    /// # Errors
    /// Names the first field that is out of range, its value and the range.
    pub fn check(&self) -> Result<(), ConfigError> {
        discount(&self.discount)?;
        iql(&self.iql)?;
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
    match *config {
        DiscountConfig::Constant { gamma } => share("discount.gamma", gamma),
        DiscountConfig::Ted { gamma, k, sigma } => {
            share("discount.gamma", gamma)?;
            share("discount.sigma", sigma)?;
            within("discount.k", k, (0.0..=100.0).contains(&k), "in [0, 100]")
        }
    }
}

fn iql(config: &IqlConfig) -> Result<(), ConfigError> {
    let IqlConfig { tau, beta, .. } = *config;
    within("iql.tau", tau, tau > 0.0 && tau < 1.0, "in (0, 1)")?;
    let holds = beta >= 0.0 && beta.is_finite();
    within("iql.beta", beta, holds, "in [0, inf)")?;
    at_least_one("iql.steps", config.steps as f64)?;
    at_least_one("iql.batch", config.batch as f64)?;
    let rate = config.target_rate;
    let holds = rate > 0.0 && rate <= 1.0;
    within("iql.target_rate", rate, holds, "in (0, 1]")?;
    positive("iql.learning_rate", config.learning_rate)?;
    positive("iql.advantage_clip", config.advantage_clip)?;
    let [low, high] = config.log_std;
    within("iql.log_std[1]", high, high.is_finite(), "in (-inf, inf)")?;
    let holds = low.is_finite() && low <= high;
    within("iql.log_std[0]", low, holds, "in (-inf, iql.log_std[1]]")?;
    let fields = ["iql.adam.beta1", "iql.adam.beta2", "iql.adam.epsilon"];
    adam(fields, config.adam)?;
    widths("iql.hidden", &config.hidden)
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

fn adam(fields: [&'static str; 3], adam: Adam) -> Result<(), ConfigError> {
    let [beta1, beta2, epsilon] = fields;
    let decay = |field, value| within(field, value, (0.0..1.0).contains(&value), "in [0, 1)");
    decay(beta1, adam.beta1)?;
    decay(beta2, adam.beta2)?;
    // Where every gradient was zero, the step is divided by it.
    small(epsilon, adam.epsilon)
}

fn at_least_one(field: &'static str, value: f64) -> Result<(), ConfigError> {
    within(field, value, value >= 1.0, "at least 1")
}

fn positive(field: &'static str, value: f64) -> Result<(), ConfigError> {
    within(
        field,
        value,
        value > 0.0 && value.is_finite(),
        "in (0, inf)",
    )
}

/// What single precision can divide by.
fn small(field: &'static str, value: f64) -> Result<(), ConfigError> {
    let holds = (1e-30..f64::INFINITY).contains(&value);
    within(field, value, holds, "in [1e-30, inf)")
}

fn within(
    field: &'static str,
    value: f64,
    holds: bool,
    range: &'static str,
) -> Result<(), ConfigError> {
    if holds {
        Ok(())
    } else {
        Err(ConfigError::OutOfRange {
            field,
            value,
            range,
        })
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
