//! Ranges of the reward sources' numbers.

use crate::config::ConfigError;
use crate::config::ranges::{adam, as_written, at_least_one, positive, small, widths, within};
use crate::nn::{AdamW, WarmupCosine};
use crate::reward::RewardConfig;
use crate::reward::oprl::{InputScaling, OprlConfig};
use crate::reward::transformer::PtConfig;
use crate::reward::transport::TransportConfig;

pub(super) fn reward(config: &RewardConfig) -> Result<(), ConfigError> {
    match config {
        RewardConfig::None {}
        | RewardConfig::True {}
        | RewardConfig::Zero {}
        | RewardConfig::Random {}
        | RewardConfig::Negative {} => Ok(()),
        RewardConfig::Oprl(config) => oprl(config),
        RewardConfig::Transformer(config) => transformer(config),
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

fn transformer(config: &PtConfig) -> Result<(), ConfigError> {
    at_least_one("reward.queries", config.queries as f64)?;
    at_least_one("reward.segment", config.segment.into())?;
    scaling(config.scaling)?;
    at_least_one("reward.layers", config.layers as f64)?;
    at_least_one("reward.heads", config.heads as f64)?;
    let (width, heads) = (config.width, config.heads);
    let holds = width >= 2 && width.is_multiple_of(heads);
    let range = "at least 2 and a multiple of reward.heads";
    within("reward.width", width as f64, holds, range)?;
    let dropout = config.dropout;
    let holds = (0.0..1.0).contains(&dropout);
    within("reward.dropout", dropout, holds, "in [0, 1)")?;
    at_least_one("reward.steps", config.steps as f64)?;
    let WarmupCosine {
        start,
        peak,
        end,
        warmup,
    } = config.rate;
    positive("reward.rate.start", start)?;
    positive("reward.rate.peak", peak)?;
    positive("reward.rate.end", end)?;
    let holds = (0.0..1.0).contains(&warmup);
    within("reward.rate.warmup", warmup, holds, "in [0, 1)")?;
    let AdamW {
        adam: constants,
        weight_decay,
    } = config.adamw;
    let holds = weight_decay >= 0.0 && weight_decay.is_finite();
    within(
        "reward.adamw.weight_decay",
        weight_decay,
        holds,
        "in [0, inf)",
    )?;
    let fields = [
        "reward.adamw.adam.beta1",
        "reward.adamw.adam.beta2",
        "reward.adamw.adam.epsilon",
    ];
    adam(fields, constants)
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
