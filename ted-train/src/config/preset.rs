//! Named compositions: the rows of the paper's tables.

use clap::ValueEnum;
use serde::{Deserialize, Serialize};

use crate::algorithm::AlgorithmConfig;
use crate::iql::IqlConfig;
use crate::nn::Backend;
use crate::reward::RewardConfig;
use crate::reward::oprl::OprlConfig;
use crate::ted::DiscountConfig;

use super::{Config, Schedule};

/// A named composition of reward source, discount and offline algorithm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// The dataset's own rewards, IQL: the upper reference.
    True,
    /// Zero rewards, IQL: what pessimism alone reaches.
    Zero,
    /// Random rewards, IQL: the lower reference.
    Random,
    /// OPRL's reward ensemble from ten answers, IQL.
    #[value(name = "oprl-i")]
    OprlI,
    /// The same with transition-dependent discounting: the method.
    #[default]
    #[serde(rename = "oprl-i+ted")]
    #[value(name = "oprl-i+ted")]
    OprlITed,
}

impl Preset {
    /// The composition with every default.
    #[must_use]
    pub fn config(self) -> Config {
        let (reward, discount) = match self {
            Self::True => (RewardConfig::True {}, DiscountConfig::CONSTANT),
            Self::Zero => (RewardConfig::Zero {}, DiscountConfig::CONSTANT),
            Self::Random => (RewardConfig::Random {}, DiscountConfig::CONSTANT),
            Self::OprlI => (
                RewardConfig::Oprl(OprlConfig::default()),
                DiscountConfig::CONSTANT,
            ),
            Self::OprlITed => (
                RewardConfig::Oprl(OprlConfig::default()),
                DiscountConfig::TED,
            ),
        };
        Config {
            preset: self,
            seed: 0,
            backend: Backend::Fused,
            unit_rewards: true,
            reward,
            discount,
            algorithm: AlgorithmConfig::Iql(IqlConfig::default()),
            schedule: Schedule::default(),
        }
    }

    /// The name as it is written on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::True => "true",
            Self::Zero => "zero",
            Self::Random => "random",
            Self::OprlI => "oprl-i",
            Self::OprlITed => "oprl-i+ted",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nn::Adam;

    #[test]
    fn the_default_is_the_paper_s_setting_with_the_constants_of_the_methods_it_builds_on() {
        let Config {
            preset,
            seed,
            unit_rewards,
            reward,
            discount,
            algorithm,
            ..
        } = Preset::default().config();
        assert_eq!((preset, seed, unit_rewards), (Preset::OprlITed, 0, true));
        let (gamma, k, sigma) = (0.99, 70.0, 0.7);
        assert_eq!(discount, DiscountConfig::Ted { gamma, k, sigma });
        assert_eq!(
            Preset::OprlI.config().discount,
            DiscountConfig::Constant { gamma }
        );
        let adam = Adam {
            beta1: 0.9,
            beta2: 0.999,
            epsilon: 1e-8,
        };
        let paper = IqlConfig {
            steps: 100_000,
            batch: 256,
            hidden: vec![256, 256],
            tau: 0.7,
            beta: 3.0,
            advantage_clip: 100.0,
            learning_rate: 3e-4,
            target_rate: 0.005,
            log_std: [-5.0, 2.0],
            adam,
        };
        assert_eq!(algorithm, AlgorithmConfig::Iql(paper));
        let RewardConfig::Oprl(oprl) = reward else {
            panic!("{reward:?}");
        };
        assert_eq!((oprl.members, oprl.rounds, oprl.queries()), (7, 3, 10));
        assert_eq!((oprl.segment, oprl.pool, oprl.adam), (50, 1000, adam));
    }
}
