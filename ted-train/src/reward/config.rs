//! The choice of a reward source.

use serde::{Deserialize, Serialize};

use super::oprl::OprlConfig;
use super::transformer::PtConfig;
use super::transport::TransportConfig;

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
}

impl RewardConfig {
    /// Whether somebody has to answer questions.
    #[must_use]
    pub fn asks(&self) -> bool {
        matches!(self, Self::Oprl(_) | Self::Transformer(_))
    }
}
