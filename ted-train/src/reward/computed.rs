//! Rewards that are computed from the dataset alone, without a question.

use firmware_sim::progress::Audience;
use rand::RngExt;

use crate::dataset::Dataset;
use crate::rng::Seed;

use super::transport::{self, TransportConfig, TransportError, transport_labels};

/// A reward that nobody has to learn.
#[derive(Clone, Copy, Debug)]
pub enum Computed<'c> {
    /// The dataset's own rewards.
    True,
    /// Zero for each transition.
    Zero,
    /// Uniform noise in [0, 1), from the stream `root/reward/random`.
    Random,
    /// The dataset's own rewards with the other sign.
    Negative,
    /// What it costs to carry an episode to the best ones.
    Transport(&'c TransportConfig),
}

impl Computed<'_> {
    /// Whether it can be computed for this dataset.
    ///
    /// # Errors
    /// When there are too few episodes to imitate.
    pub fn check(self, dataset: &Dataset) -> Result<(), TransportError> {
        match self {
            Self::Transport(config) => transport::check(dataset, config),
            _ => Ok(()),
        }
    }

    /// Whether it comes from the dataset's own rewards: it is them, of whatever sign, or it takes the best episodes for experts.
    #[must_use]
    pub fn looks_at_rewards(self) -> bool {
        matches!(self, Self::True | Self::Negative | Self::Transport(_))
    }

    /// The raw reward of each transition.
    ///
    /// # Errors
    /// When [`Self::check`] does, a cost leaves the range of single precision, or somebody asks to stop.
    pub fn raw_rewards(
        self,
        dataset: &Dataset,
        root: Seed,
        audience: Audience,
    ) -> Result<Vec<f32>, TransportError> {
        let truth = dataset.rewards_true();
        Ok(match self {
            Self::True => truth.to_vec(),
            Self::Zero => vec![0.0; truth.len()],
            Self::Random => {
                let mut rng = root.child("reward/random").rng();
                truth.iter().map(|_| rng.random()).collect()
            }
            Self::Negative => truth.iter().map(|reward| -reward).collect(),
            Self::Transport(config) => transport_labels(dataset, config, audience)?,
        })
    }
}
