//! Recipes: which behaviour records which episode.

use super::CollectError;
use crate::dataset::minari::Behaviour;
use firmware_sim::bridge;
use std::fmt;
use std::str::FromStr;

/// How the actions of a dataset are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Recipe {
    /// The paper's: one episode in twenty by the scripted policy with normal noise of 0.8, then the same policy with a uniformly
    /// random action in four steps of five.
    Paper,
    /// The scripted policy as it is: what a good run looks like.
    Expert,
}

/// One episode in this many is of the paper's noisy part.
const NOISY_ONE_IN: u32 = 20;

impl Recipe {
    /// Every recipe.
    pub const ALL: [Self; 2] = [Self::Paper, Self::Expert];

    /// Episodes of a full dataset.
    #[must_use]
    pub fn default_episodes(self) -> u32 {
        match self {
            Self::Paper => 1000,
            Self::Expert => 50,
        }
    }

    /// What makes the actions of `episode` in a dataset of `total`.
    #[must_use]
    pub fn behaviour(self, episode: u32, total: u32) -> Behaviour {
        let (part, played) = match self {
            Self::Paper if episode < noisy_episodes(total) => {
                ("noisy", bridge::Behaviour::PAPER_NOISY)
            }
            Self::Paper => ("epsilon", bridge::Behaviour::PAPER_EPSILON),
            Self::Expert => ("expert", bridge::Behaviour::EXPERT),
        };
        Behaviour {
            part: part.into(),
            noise_std: played.noise_std,
            epsilon: played.epsilon,
        }
    }
}

/// Size of the paper's noisy part: a twentieth, rounded, and at least one.
fn noisy_episodes(total: u32) -> u32 {
    ((total / NOISY_ONE_IN) + u32::from(total % NOISY_ONE_IN >= NOISY_ONE_IN / 2)).max(1)
}

impl fmt::Display for Recipe {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Paper => "paper",
            Self::Expert => "expert",
        })
    }
}

impl FromStr for Recipe {
    type Err = CollectError;

    fn from_str(name: &str) -> Result<Self, CollectError> {
        Self::ALL
            .into_iter()
            .find(|recipe| recipe.to_string() == name)
            .ok_or_else(|| CollectError::Recipe {
                name: name.into(),
                known: Self::ALL.map(|recipe| recipe.to_string()).join(", "),
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_paper_has_one_noisy_episode_in_twenty_and_at_least_one() {
        let noisy = |total| {
            (0..total)
                .filter(|&episode| Recipe::Paper.behaviour(episode, total).part == "noisy")
                .count()
        };
        assert_eq!(
            [1, 2, 20, 29, 30, 100, 1000].map(noisy),
            [1, 1, 1, 1, 2, 5, 50]
        );
        assert_eq!(Recipe::Paper.behaviour(50, 1000).epsilon, 0.8);
        assert_eq!(Recipe::Paper.behaviour(49, 1000).epsilon, 0.0);
    }

    #[test]
    fn recipes_are_found_by_name() {
        for recipe in Recipe::ALL {
            assert_eq!(recipe.to_string().parse::<Recipe>().unwrap(), recipe);
        }
        let error = "papr".parse::<Recipe>().unwrap_err();
        assert_eq!(
            error.to_string(),
            "no recipe `papr`: the recipes are paper, expert"
        );
    }
}
