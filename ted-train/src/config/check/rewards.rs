//! Ranges of the reward sources' numbers.

use crate::config::ConfigError;
use crate::config::ranges::{adam, as_written, at_least_one, positive, small, widths, within};
use crate::reward::RewardConfig;
use crate::reward::oprl::{InputScaling, OprlConfig};
use crate::reward::transport::TransportConfig;

pub(super) fn reward(config: &RewardConfig) -> Result<(), ConfigError> {
    match config {
        RewardConfig::None {}
        | RewardConfig::True {}
        | RewardConfig::Zero {}
        | RewardConfig::Random {}
        | RewardConfig::Negative {} => Ok(()),
        RewardConfig::Oprl(config) => oprl(config),
        RewardConfig::Transport(config) => transport(config),
    }
}

fn oprl(config: &OprlConfig) -> Result<(), ConfigError> {
    let members = config.members;
    let holds = (1..=ted_core::MAX_MEMBERS).contains(&members);
    within("reward.members", members as f64, holds, "1 to 8")?;
    at_least_one("reward.segment", config.segment.into())?;
    at_least_one("reward.pool", config.pool as f64)?;
    positive("reward.learning_rate", config.learning_rate)?;
    scaling(config.scaling)?;
    let fields = [
        "reward.adam.beta1",
        "reward.adam.beta2",
        "reward.adam.epsilon",
    ];
    adam(fields, config.adam)?;
    widths("reward.hidden", &config.hidden)
}

fn transport(config: &TransportConfig) -> Result<(), ConfigError> {
    at_least_one("reward.experts", config.experts as f64)?;
    scaling(config.scaling)?;
    small("reward.epsilon", config.epsilon)?;
    at_least_one("reward.iterations", config.iterations.into())?;
    positive("reward.alpha", config.alpha)?;
    positive("reward.beta", config.beta)
}

fn scaling(scaling: InputScaling) -> Result<(), ConfigError> {
    match scaling {
        InputScaling::Raw {} => Ok(()),
        // A channel that never moves is divided by the floor.
        InputScaling::Standard { floor } => small("reward.scaling.floor", as_written(floor)),
    }
}
