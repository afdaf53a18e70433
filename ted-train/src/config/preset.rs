//! Named compositions: the rows of the paper's tables.

use clap::ValueEnum;
use serde::{Deserialize, Serialize};

use crate::iql::IqlConfig;
use crate::nn::Backend;
use crate::reward::RewardConfig;
use crate::reward::oprl::OprlConfig;
use crate::ted::DiscountConfig;

use super::{Config, Schedule};

/// A named composition of reward source, discount and offline algorithm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
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
            backend: Backend::Flex,
            unit_rewards: true,
            reward,
            discount,
            iql: IqlConfig::default(),
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
