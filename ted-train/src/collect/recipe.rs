//! Recipes: which behaviour records which episode.

use super::CollectError;
use crate::dataset::minari;
use firmware_sim::bridge::Behaviour;
use std::fmt;
use std::str::FromStr;

/// How the actions of a dataset are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Recipe {
    /// The paper's: one episode in twenty by the scripted policy with normal noise of 0.8, then the same policy with a uniformly
    /// random action in four steps of five.
    Paper,
    /// The paper's, and every action is pushed the same way: noise whose mean is not zero.
    Biased,
    /// The paper's, and the hand drifts: noise that is correlated in time.
    Drift,
    /// The scripted policy as it is: what a good run looks like.
    Expert,
}

/// One episode in this many is of the paper's noisy part.
const NOISY_ONE_IN: u32 = 20;
/// Standard deviation of what [`Recipe::Drift`] adds to every action of the hand ...
const DRIFT_STD: f64 = 0.4;
/// ... and its correlation from one step to the next: half of it is left after 34 steps, 0.4 seconds.
const DRIFT_CORRELATION: f64 = 0.98;

impl Recipe {
    /// Every recipe.
    pub const ALL: [Self; 4] = [Self::Paper, Self::Biased, Self::Drift, Self::Expert];

    /// Episodes of a full dataset.
    #[must_use]
    pub const fn default_episodes(self) -> u32 {
        match self {
            Self::Paper | Self::Biased | Self::Drift => 1000,
            Self::Expert => 50,
        }
    }

    /// Good episodes, those of the noisy part, in a dataset of `total`: a twentieth, rounded, and at least one. None for a
    /// recipe that has no such part.
    #[must_use]
    pub const fn default_good(self, total: u32) -> Option<u32> {
        match self {
            Self::Paper | Self::Biased | Self::Drift => {
                let twentieth =
                    total / NOISY_ONE_IN + (total % NOISY_ONE_IN >= NOISY_ONE_IN / 2) as u32;
                Some(if twentieth == 0 { 1 } else { twentieth })
            }
            Self::Expert => None,
        }
    }

    /// What makes the actions of `episode` in a dataset whose first `good` episodes are the good ones; `push` is what biased
    /// ones are pushed by.
    pub(super) fn played(self, episode: u32, good: u32, push: [f64; 4]) -> Played {
        let noisy = Played {
            part: "noisy".into(),
            behaviour: Behaviour::PAPER_NOISY,
        };
        let epsilon = Played {
            part: "epsilon".into(),
            behaviour: Behaviour::PAPER_EPSILON,
        };
        let paper = if episode < good { noisy } else { epsilon };
        match self {
            Self::Paper => paper,
            Self::Biased => paper.with(|behaviour| behaviour.push = push),
            Self::Drift => paper.with(|behaviour| {
                behaviour.drift_std = DRIFT_STD;
                behaviour.drift_correlation = DRIFT_CORRELATION;
            }),
            Self::Expert => Played {
                part: "expert".into(),
                behaviour: Behaviour::EXPERT,
            },
        }
    }
}

/// How an episode is played, and the part of the recipe that it belongs to.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Played {
    pub part: String,
    pub behaviour: Behaviour,
}

impl Played {
    fn with(mut self, change: impl FnOnce(&mut Behaviour)) -> Self {
        change(&mut self.behaviour);
        self
    }

    /// The same after one of a task's two purposes.
    pub fn after(mut self, purpose: u8) -> Self {
        self.part
            .push_str(if purpose == 0 { "-first" } else { "-second" });
        self.with(|behaviour| behaviour.purpose = purpose)
    }

    /// As it is noted beside the episode.
    pub fn note(&self) -> minari::Behaviour {
        let Behaviour {
            noise_std,
            epsilon,
            push,
            drift_std,
            drift_correlation,
            purpose,
        } = self.behaviour;
        minari::Behaviour {
            part: self.part.clone(),
            noise_std,
            epsilon,
            push,
            drift_std,
            drift_correlation,
            purpose,
        }
    }
}

impl fmt::Display for Recipe {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Paper => "paper",
            Self::Biased => "biased",
            Self::Drift => "drift",
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

    const PUSH: [f64; 4] = [0.15, -0.1, 0.05, 0.0];

    #[test]
    fn the_paper_has_one_noisy_episode_in_twenty_and_at_least_one() {
        let good = |total| Recipe::Paper.default_good(total);
        assert_eq!(
            [1, 2, 20, 29, 30, 100, 300, 1000].map(good),
            [1, 1, 1, 1, 2, 5, 15, 50].map(Some)
        );
        assert_eq!(Recipe::Paper.played(50, 50, PUSH).behaviour.epsilon, 0.8);
        assert_eq!(Recipe::Paper.played(49, 50, PUSH).behaviour.epsilon, 0.0);
        assert_eq!(Recipe::Paper.played(0, 0, PUSH).part, "epsilon");
    }

    #[test]
    fn a_biased_and_a_drifting_log_are_the_paper_s_with_something_on_top() {
        for episode in [0, 49, 50, 999] {
            let paper = Recipe::Paper.played(episode, 50, PUSH);
            let biased = Recipe::Biased.played(episode, 50, PUSH);
            let drift = Recipe::Drift.played(episode, 50, PUSH);
            assert_eq!(biased.behaviour.push, PUSH);
            assert_eq!(biased.with(|b| b.push = [0.0; 4]), paper);
            assert_eq!(drift.behaviour.drift_std, 0.4);
            let without = drift.with(|b| (b.drift_std, b.drift_correlation) = (0.0, 0.0));
            assert_eq!(without, paper);
        }
    }

    #[test]
    fn recipes_are_found_by_name() {
        for recipe in Recipe::ALL {
            assert_eq!(recipe.to_string().parse::<Recipe>().unwrap(), recipe);
        }
        let error = "papr".parse::<Recipe>().unwrap_err();
        assert_eq!(
            error.to_string(),
            "no recipe `papr`: the recipes are paper, biased, drift, expert"
        );
    }
}
