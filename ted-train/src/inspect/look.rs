//! What the logs say by themselves, as the model of episodes sees them before it asks anything.

use firmware_sim::progress::Audience;
use serde::Serialize;

use crate::dataset::Dataset;
use crate::nn::Backend;
use crate::reward::episodes::{Descriptors, EpisodesConfig, Look};
use crate::reward::{LearnError, Material, RewardLearner};
use crate::rng::Seed;

/// The descriptors of a dataset's episodes.
#[derive(Clone, Debug, Serialize)]
pub struct LookText {
    /// Competence first, then whereabouts.
    pub descriptors: Vec<DescriptorText>,
}

/// One number of every episode.
#[derive(Clone, Debug, Serialize)]
pub struct DescriptorText {
    /// Which it is.
    pub name: String,
    /// How far the two halves of an episode agree on it, from 0 to 1.
    pub reliability: f64,
    /// What it is made of.
    pub made_of: String,
    /// The episodes that have most of it, the first the most.
    pub most: Vec<usize>,
}

/// Channels of a direction and episodes of a descriptor that are named.
const NAMED: usize = 3;

/// A look with the default configuration and seed 0.
///
/// # Errors
/// When there are fewer than two episodes, the clone does not come out finite, or somebody asks to stop.
pub fn look(dataset: &Dataset, audience: Audience) -> Result<LookText, LearnError> {
    let config = EpisodesConfig::default();
    config.check(dataset)?;
    let on = Material {
        dataset,
        seed: Seed::root(0).child("reward"),
        backend: Backend::default(),
        audience,
    };
    let look = Look::at(&config, on)?;
    let descriptors = look.descriptors();
    let all = 0..descriptors.reliability.len();
    Ok(LookText {
        descriptors: all.map(|j| describe(descriptors, j, dataset)).collect(),
    })
}

fn describe(descriptors: &Descriptors, j: usize, dataset: &Dataset) -> DescriptorText {
    let made_of = match j.checked_sub(1) {
        None => "how far its actions go the way that all episodes go on average".to_owned(),
        Some(direction) => {
            let weights = descriptors.channels(direction);
            let named = weights.iter().take(NAMED).map(|&(channel, weight)| {
                let name = &dataset.robot().observation[channel].name;
                format!("{}{name}", if weight < 0.0 { "-" } else { "+" })
            });
            named.collect::<Vec<_>>().join(" ")
        }
    };
    DescriptorText {
        name: Descriptors::name(j),
        reliability: descriptors.reliability[j],
        made_of,
        most: descriptors.most(j, NAMED),
    }
}
