//! The choice of a reward source, and the one place that knows which there are.

use serde::{Deserialize, Serialize};

use super::episodes::EpisodesConfig;
use super::oprl::OprlConfig;
use super::transformer::PtConfig;
use super::transport::TransportConfig;
use super::{Computed, RewardLearner};

/// Where the rewards of a run come from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "source", rename_all = "kebab-case", deny_unknown_fields)]
pub enum RewardConfig {
    /// None: for an algorithm that learns from actions alone.
    None {},
    /// The dataset's own rewards: what a run could reach with perfect labels.
    True {},
    /// Zero everywhere: what pessimism alone reaches.
    Zero {},
    /// Uniform noise: what a reward without information reaches.
    Random {},
    /// The dataset's own rewards with the other sign: how far a wrong reward leads.
    Negative {},
    /// An ensemble learned from preferences.
    Oprl(OprlConfig),
    /// A transformer learned from preferences, whose reward looks at what came before (Preference Transformer).
    Transformer(PtConfig),
    /// What it costs to carry an episode to those of the highest true returns (OTR).
    Transport(TransportConfig),
    /// A Bayesian model of whole episodes, learned from preferences.
    Episodes(EpisodesConfig),
}

/// How a run comes to its rewards.
pub enum Source<'c> {
    /// From the dataset alone.
    Computed(Computed<'c>),
    /// From answers.
    Learned(&'c dyn RewardLearner),
}

impl RewardConfig {
    /// How a run comes to them.
    #[must_use]
    pub fn source(&self) -> Source<'_> {
        match self {
            Self::None {} | Self::Zero {} => Source::Computed(Computed::Zero),
            Self::True {} => Source::Computed(Computed::True),
            Self::Random {} => Source::Computed(Computed::Random),
            Self::Negative {} => Source::Computed(Computed::Negative),
            Self::Transport(config) => Source::Computed(Computed::Transport(config)),
            Self::Oprl(config) => Source::Learned(config),
            Self::Transformer(config) => Source::Learned(config),
            Self::Episodes(config) => Source::Learned(config),
        }
    }

    /// The same with so many answers, where they are learned from answers.
    #[must_use]
    pub fn asking(&self, answers: usize) -> Self {
        match self {
            Self::Oprl(config) => Self::Oprl(config.asking(answers)),
            Self::Transformer(config) => Self::Transformer(PtConfig {
                queries: answers,
                ..config.clone()
            }),
            Self::Episodes(config) => Self::Episodes(EpisodesConfig {
                queries: answers,
                ..config.clone()
            }),
            Self::None {}
            | Self::True {}
            | Self::Zero {}
            | Self::Random {}
            | Self::Negative {}
            | Self::Transport(_) => self.clone(),
        }
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_none(&self) -> bool {
        matches!(self, Self::None {})
    }

    /// The learner, where they are learned from answers.
    #[must_use]
    pub fn learner(&self) -> Option<&dyn RewardLearner> {
        match self.source() {
            Source::Learned(learner) => Some(learner),
            Source::Computed(_) => None,
        }
    }
}
