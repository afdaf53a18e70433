//! Ranges of the offline algorithms' numbers.

use crate::algorithm::AlgorithmConfig;
use crate::algorithm::atac::AtacConfig;
use crate::algorithm::awr::AwrConfig;
use crate::algorithm::bc::BcConfig;
use crate::algorithm::conditioned::ConditionedConfig;
use crate::algorithm::iql::IqlConfig;
use crate::algorithm::oppo::OppoConfig;
use crate::config::ConfigError;
use crate::config::ranges::{Table, as_written};

const ALGORITHM: Table = Table("algorithm");

pub(super) fn algorithm(config: &AlgorithmConfig) -> Result<(), ConfigError> {
    ALGORITHM.repeated("steps", config.steps() as f64)?;
    ALGORITHM.at_least_one("batch", config.batch() as f64)?;
    match config {
        AlgorithmConfig::Iql(config) => iql(config),
        AlgorithmConfig::Atac(config) => atac(config),
        AlgorithmConfig::Awr(config) => awr(config),
        AlgorithmConfig::Bc(config) => bc(config),
        AlgorithmConfig::Conditioned(config) => conditioned(config),
        AlgorithmConfig::Oppo(config) => oppo(config),
    }
}

fn iql(config: &IqlConfig) -> Result<(), ConfigError> {
    let tau = config.tau;
    ALGORITHM.within("tau", tau, tau > 0.0 && tau < 1.0, "in (0, 1)")?;
    ALGORITHM.not_negative("beta", config.beta)?;
    average_rate("target_rate", config.target_rate)?;
    ALGORITHM.positive("learning_rate", config.learning_rate)?;
    ALGORITHM.positive("advantage_clip", config.advantage_clip)?;
    let [low, high] = config.log_std;
    ALGORITHM.within("log_std[1]", high, high.is_finite(), "in (-inf, inf)")?;
    let holds = low.is_finite() && low <= high;
    ALGORITHM.within("log_std[0]", low, holds, "in (-inf, algorithm.log_std[1]]")?;
    ALGORITHM.adam("adam", config.adam)?;
    ALGORITHM.widths("hidden", &config.hidden)
}

fn atac(config: &AtacConfig) -> Result<(), ConfigError> {
    let (warm, steps) = (config.warm_start, config.steps);
    let range = "less than algorithm.steps: the policy only imitates until then";
    ALGORITHM.within("warm_start", warm as f64, warm < steps, range)?;
    ALGORITHM.not_negative("beta", config.beta)?;
    ALGORITHM.positive("fast_rate", config.fast_rate)?;
    ALGORITHM.positive("slow_rate", config.slow_rate)?;
    average_rate("target_rate", config.target_rate)?;
    ALGORITHM.positive("norm_limit", config.norm_limit)?;
    let [low, high] = config.std;
    ALGORITHM.positive("std[0]", low)?;
    let holds = high >= low && high.is_finite();
    ALGORITHM.within("std[1]", high, holds, "in [algorithm.std[0], inf)")?;
    ALGORITHM.adam("adam", config.adam)?;
    ALGORITHM.widths("hidden", &config.hidden)
}

fn awr(config: &AwrConfig) -> Result<(), ConfigError> {
    let (critic, steps) = (config.critic_steps, config.steps);
    ALGORITHM.repeated("critic_steps", critic as f64)?;
    ALGORITHM.repeated("actor_steps", config.actor_steps as f64)?;
    let range = "less than algorithm.steps: the policy learns nothing until then";
    ALGORITHM.within("critic_steps", critic as f64, critic < steps, range)?;
    ALGORITHM.positive("critic_rate", config.critic_rate)?;
    ALGORITHM.positive("actor_rate", config.actor_rate)?;
    ALGORITHM.below_one("momentum", config.momentum)?;
    ALGORITHM.positive("value_scale", config.value_scale)?;
    ALGORITHM.share("lambda", config.lambda)?;
    ALGORITHM.positive("temperature", config.temperature)?;
    ALGORITHM.positive("weight_clip", config.weight_clip)?;
    ALGORITHM.positive("std", config.std)?;
    ALGORITHM.positive("output_scale", config.output_scale)?;
    ALGORITHM.widths("hidden", &config.hidden)
}

fn bc(config: &BcConfig) -> Result<(), ConfigError> {
    ALGORITHM.positive("learning_rate", config.learning_rate)?;
    ALGORITHM.adam("adam", config.adam)?;
    ALGORITHM.widths("hidden", &config.hidden)
}

fn conditioned(config: &ConditionedConfig) -> Result<(), ConfigError> {
    let (first, last) = (config.learning_rate, config.final_rate);
    ALGORITHM.positive("learning_rate", first)?;
    let holds = (0.0..=first).contains(&last);
    ALGORITHM.within("final_rate", last, holds, "in [0, algorithm.learning_rate]")?;
    ALGORITHM.not_negative("weight_decay", config.weight_decay)?;
    average_rate("average_rate", config.average_rate)?;
    ALGORITHM.at_least_one("best", config.best as f64)?;
    ALGORITHM.not_negative("aim", config.aim)?;
    ALGORITHM.not_negative("haste", config.haste)?;
    ALGORITHM.adam("adam", config.adam)?;
    ALGORITHM.widths("hidden", &config.hidden)
}

fn oppo(config: &OppoConfig) -> Result<(), ConfigError> {
    ALGORITHM.at_least_one("queries", config.queries as f64)?;
    ALGORITHM.answers("queries", config.queries as f64)?;
    ALGORITHM.at_least_one("segment", config.segment.into())?;
    ALGORITHM.at_least_one("layers", config.layers as f64)?;
    ALGORITHM.heads(config.heads, config.width, 1)?;
    ALGORITHM.at_least_one("latent", config.latent as f64)?;
    ALGORITHM.below_one("dropout", config.dropout)?;
    ALGORITHM.positive("learning_rate", config.learning_rate)?;
    ALGORITHM.positive("latent_rate", config.latent_rate)?;
    ALGORITHM.positive("clip", as_written(config.clip))?;
    ALGORITHM.not_negative("preference_weight", config.preference_weight)?;
    ALGORITHM.not_negative("norm_weight", config.norm_weight)?;
    ALGORITHM.not_negative("margin", as_written(config.margin))?;
    ALGORITHM.not_negative("noise", as_written(config.noise))?;
    ALGORITHM.adamw("adamw", config.adamw)
}

fn average_rate(field: &str, rate: f64) -> Result<(), ConfigError> {
    let holds = rate > 0.0 && rate <= 1.0;
    ALGORITHM.within(field, rate, holds, "in (0, 1]")
}
