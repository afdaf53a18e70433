//! Ranges of the offline algorithms' numbers.

use crate::algorithm::AlgorithmConfig;
use crate::algorithm::atac::AtacConfig;
use crate::algorithm::awr::AwrConfig;
use crate::algorithm::bc::BcConfig;
use crate::algorithm::iql::IqlConfig;
use crate::algorithm::oppo::OppoConfig;
use crate::config::ConfigError;
use crate::config::ranges::{adam, as_written, at_least_one, positive, widths, within};
use crate::nn::AdamW;

pub(super) fn algorithm(config: &AlgorithmConfig) -> Result<(), ConfigError> {
    at_least_one("algorithm.steps", config.steps() as f64)?;
    at_least_one("algorithm.batch", config.batch() as f64)?;
    match config {
        AlgorithmConfig::Iql(config) => iql(config),
        AlgorithmConfig::Atac(config) => atac(config),
        AlgorithmConfig::Awr(config) => awr(config),
        AlgorithmConfig::Bc(config) => bc(config),
        AlgorithmConfig::Oppo(config) => oppo(config),
    }
}

const ADAM: [&str; 3] = [
    "algorithm.adam.beta1",
    "algorithm.adam.beta2",
    "algorithm.adam.epsilon",
];

fn iql(config: &IqlConfig) -> Result<(), ConfigError> {
    let IqlConfig { tau, beta, .. } = *config;
    within("algorithm.tau", tau, tau > 0.0 && tau < 1.0, "in (0, 1)")?;
    let holds = beta >= 0.0 && beta.is_finite();
    within("algorithm.beta", beta, holds, "in [0, inf)")?;
    target_rate(config.target_rate)?;
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
    adam(ADAM, config.adam)?;
    widths("algorithm.hidden", &config.hidden)
}

fn atac(config: &AtacConfig) -> Result<(), ConfigError> {
    let (warm, steps) = (config.warm_start, config.steps);
    let range = "less than algorithm.steps: the policy only imitates until then";
    within("algorithm.warm_start", warm as f64, warm < steps, range)?;
    let beta = config.beta;
    let holds = beta >= 0.0 && beta.is_finite();
    within("algorithm.beta", beta, holds, "in [0, inf)")?;
    positive("algorithm.fast_rate", config.fast_rate)?;
    positive("algorithm.slow_rate", config.slow_rate)?;
    target_rate(config.target_rate)?;
    positive("algorithm.norm_limit", config.norm_limit)?;
    let [low, high] = config.std;
    positive("algorithm.std[0]", low)?;
    let holds = high >= low && high.is_finite();
    within(
        "algorithm.std[1]",
        high,
        holds,
        "in [algorithm.std[0], inf)",
    )?;
    adam(ADAM, config.adam)?;
    widths("algorithm.hidden", &config.hidden)
}

fn awr(config: &AwrConfig) -> Result<(), ConfigError> {
    at_least_one("algorithm.critic_steps", config.critic_steps as f64)?;
    at_least_one("algorithm.actor_steps", config.actor_steps as f64)?;
    let (critic, steps) = (config.critic_steps, config.steps);
    let range = "less than algorithm.steps: the policy learns nothing until then";
    within(
        "algorithm.critic_steps",
        critic as f64,
        critic < steps,
        range,
    )?;
    let share = |field, value| within(field, value, (0.0..=1.0).contains(&value), "in [0, 1]");
    positive("algorithm.critic_rate", config.critic_rate)?;
    positive("algorithm.actor_rate", config.actor_rate)?;
    let momentum = config.momentum;
    let holds = (0.0..1.0).contains(&momentum);
    within("algorithm.momentum", momentum, holds, "in [0, 1)")?;
    positive("algorithm.value_scale", config.value_scale)?;
    share("algorithm.lambda", config.lambda)?;
    positive("algorithm.temperature", config.temperature)?;
    positive("algorithm.weight_clip", config.weight_clip)?;
    positive("algorithm.std", config.std)?;
    positive("algorithm.output_scale", config.output_scale)?;
    widths("algorithm.hidden", &config.hidden)
}

fn bc(config: &BcConfig) -> Result<(), ConfigError> {
    positive("algorithm.learning_rate", config.learning_rate)?;
    adam(ADAM, config.adam)?;
    widths("algorithm.hidden", &config.hidden)
}

fn oppo(config: &OppoConfig) -> Result<(), ConfigError> {
    at_least_one("algorithm.queries", config.queries as f64)?;
    at_least_one("algorithm.segment", config.segment.into())?;
    at_least_one("algorithm.layers", config.layers as f64)?;
    at_least_one("algorithm.heads", config.heads as f64)?;
    let (width, heads) = (config.width, config.heads);
    let holds = width >= 1 && width.is_multiple_of(heads);
    let range = "a multiple of algorithm.heads";
    within("algorithm.width", width as f64, holds, range)?;
    at_least_one("algorithm.latent", config.latent as f64)?;
    let dropout = config.dropout;
    let holds = (0.0..1.0).contains(&dropout);
    within("algorithm.dropout", dropout, holds, "in [0, 1)")?;
    positive("algorithm.learning_rate", config.learning_rate)?;
    positive("algorithm.latent_rate", config.latent_rate)?;
    positive("algorithm.clip", as_written(config.clip))?;
    let at_least_zero = |field, value: f64| {
        let holds = value >= 0.0 && value.is_finite();
        within(field, value, holds, "in [0, inf)")
    };
    at_least_zero("algorithm.preference_weight", config.preference_weight)?;
    at_least_zero("algorithm.norm_weight", config.norm_weight)?;
    at_least_zero("algorithm.margin", as_written(config.margin))?;
    at_least_zero("algorithm.noise", as_written(config.noise))?;
    let AdamW {
        adam: constants,
        weight_decay,
    } = config.adamw;
    at_least_zero("algorithm.adamw.weight_decay", weight_decay)?;
    let fields = [
        "algorithm.adamw.adam.beta1",
        "algorithm.adamw.adam.beta2",
        "algorithm.adamw.adam.epsilon",
    ];
    adam(fields, constants)
}

fn target_rate(rate: f64) -> Result<(), ConfigError> {
    let holds = rate > 0.0 && rate <= 1.0;
    within("algorithm.target_rate", rate, holds, "in (0, 1]")
}
