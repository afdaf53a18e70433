//! Ranges of the reward sources' numbers.

use crate::config::ConfigError;
use crate::config::ranges::{Table, as_written};
use crate::dataset::Clip;
use crate::nn::WarmupCosine;
use crate::reward::episodes::{EpisodesConfig, Fitting};
use crate::reward::oprl::OprlConfig;
use crate::reward::transformer::PtConfig;
use crate::reward::transport::TransportConfig;
use crate::reward::{InputScaling, RewardConfig};

const REWARD: Table = Table("reward");

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
        RewardConfig::Episodes(config) => episodes(config),
    }
}

fn oprl(config: &OprlConfig) -> Result<(), ConfigError> {
    let members = config.members;
    let holds = (1..=ted_core::MAX_MEMBERS).contains(&members);
    REWARD.within("members", members as f64, holds, "1 to 8")?;
    REWARD.answers("rounds", config.rounds.into())?;
    REWARD.at_most("epochs", config.epochs.into(), 1e6)?;
    if let Clip::Steps(steps) = config.segment {
        REWARD.at_least_one("segment", steps.into())?;
    }
    REWARD.at_least_one("pool", config.pool as f64)?;
    REWARD.positive("learning_rate", config.learning_rate)?;
    scaling(config.scaling)?;
    REWARD.adam("adam", config.adam)?;
    REWARD.widths("hidden", &config.hidden)
}

fn transformer(config: &PtConfig) -> Result<(), ConfigError> {
    REWARD.at_least_one("queries", config.queries as f64)?;
    REWARD.answers("queries", config.queries as f64)?;
    REWARD.at_least_one("segment", config.segment.into())?;
    scaling(config.scaling)?;
    REWARD.at_least_one("layers", config.layers as f64)?;
    REWARD.heads(config.heads, config.width, 2)?;
    REWARD.below_one("dropout", config.dropout)?;
    REWARD.repeated("steps", config.steps as f64)?;
    let WarmupCosine {
        start,
        peak,
        end,
        warmup,
    } = config.rate;
    REWARD.positive("rate.start", start)?;
    REWARD.positive("rate.peak", peak)?;
    REWARD.positive("rate.end", end)?;
    REWARD.below_one("rate.warmup", warmup)?;
    REWARD.adamw("adamw", config.adamw)
}

fn transport(config: &TransportConfig) -> Result<(), ConfigError> {
    REWARD.at_least_one("experts", config.experts as f64)?;
    scaling(config.scaling)?;
    REWARD.small("epsilon", config.epsilon)?;
    REWARD.repeated("iterations", config.iterations.into())?;
    REWARD.positive("alpha", config.alpha)?;
    REWARD.positive("beta", config.beta)
}

fn episodes(config: &EpisodesConfig) -> Result<(), ConfigError> {
    REWARD.answers("queries", config.queries as f64)?;
    REWARD.at_least_one("directions", config.directions as f64)?;
    REWARD.at_least_one("block", config.block as f64)?;
    let mean = config.competence;
    REWARD.within("competence", mean, mean.is_finite(), "in (-inf, inf)")?;
    REWARD.not_negative("competence_std", config.competence_std)?;
    REWARD.not_negative("direction_std", config.direction_std)?;
    REWARD.positive("clip", config.clip)?;
    REWARD.positive("slope", config.slope)?;
    REWARD.below_one("lapse", config.lapse)?;
    REWARD.at_least_one("pool", config.pool as f64)?;
    REWARD.at_least_one("candidates", config.candidates as f64)?;
    REWARD.at_least_one("samples", config.samples as f64)?;
    REWARD.at_most("samples", config.samples as f64, 1e6)?;
    REWARD.at_least_one("thinning", config.thinning as f64)?;
    REWARD.at_most("thinning", config.thinning as f64, 1e6)?;
    REWARD.share("sure", config.sure)?;
    fitting(Table("reward.clone"), &config.clone)?;
    fitting(Table("reward.network"), &config.network)
}

fn fitting(table: Table, config: &Fitting) -> Result<(), ConfigError> {
    table.repeated("steps", config.steps as f64)?;
    table.at_least_one("batch", config.batch as f64)?;
    table.positive("learning_rate", config.learning_rate)?;
    table.adam("adam", config.adam)?;
    table.widths("hidden", &config.hidden)
}

fn scaling(scaling: InputScaling) -> Result<(), ConfigError> {
    match scaling {
        InputScaling::Raw {} => Ok(()),
        // A channel that never moves is divided by the floor.
        InputScaling::Standard { floor } => REWARD.small("scaling.floor", as_written(floor)),
    }
}
