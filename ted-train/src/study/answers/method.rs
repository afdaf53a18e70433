//! What is compared: ours, ours with answers that are worth nothing or less, and what a reader has to see beside it.

use clap::ValueEnum;
use serde::{Deserialize, Serialize};

use crate::config::Preset;

/// A column of the benchmark.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, ValueEnum,
)]
pub enum Method {
    /// Imitation of the logs, without an answer and without a reward.
    #[serde(rename = "clone")]
    Clone,
    /// Pessimism alone: a reward of zero.
    #[serde(rename = "zero")]
    Zero,
    /// The paper's method with ten answers.
    #[serde(rename = "oprl-i+ted")]
    #[value(name = "oprl-i+ted")]
    OprlITed,
    /// Ours.
    #[serde(rename = "steer")]
    Steer,
    /// Ours, when the answers are a coin's.
    #[serde(rename = "steer, random answers")]
    SteerRandom,
    /// Ours, when each answer is the opposite of the right one.
    #[serde(rename = "steer, reversed answers")]
    SteerReversed,
    /// The dataset's own rewards: what perfect labels reach.
    #[serde(rename = "true")]
    True,
}

impl Method {
    /// All of them, in the order of the columns.
    pub const ALL: [Self; 7] = [
        Self::Clone,
        Self::Zero,
        Self::OprlITed,
        Self::Steer,
        Self::SteerRandom,
        Self::SteerReversed,
        Self::True,
    ];

    /// What a table calls it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Clone => "clone",
            Self::Zero => "zero",
            Self::OprlITed => "oprl-i+ted",
            Self::Steer => "steer",
            Self::SteerRandom => "steer, random answers",
            Self::SteerReversed => "steer, reversed answers",
            Self::True => "true",
        }
    }

    /// The preset that it starts from.
    #[must_use]
    pub const fn preset(self) -> Preset {
        match self {
            Self::Clone => Preset::Bc,
            Self::Zero => Preset::Zero,
            Self::OprlITed => Preset::OprlITed,
            Self::Steer | Self::SteerRandom | Self::SteerReversed => Preset::Steer,
            Self::True => Preset::True,
        }
    }

    /// What is changed about the preset. IQL has the updates of `docs/methods.jsonl`, the clone as many as it gains from.
    pub(super) const fn sets(self) -> &'static [&'static str] {
        match self {
            Self::Clone => &["algorithm.steps=20000"],
            Self::Zero | Self::OprlITed | Self::True => &["algorithm.steps=50000"],
            Self::Steer => &[],
            Self::SteerRandom => &["teacher.says=random"],
            Self::SteerReversed => &["teacher.says=reversed"],
        }
    }

    /// What a run takes, in minutes of a core of 2024: enough to share work out by.
    pub(super) const fn minutes(self) -> f64 {
        match self {
            Self::Clone => 1.0,
            Self::Steer | Self::SteerRandom | Self::SteerReversed => 1.7,
            Self::Zero | Self::OprlITed | Self::True => 8.5,
        }
    }

    /// Whether it learns values, which takes most of the study's time.
    pub(super) const fn is_slow(self) -> bool {
        matches!(self, Self::Zero | Self::OprlITed | Self::True)
    }
}
