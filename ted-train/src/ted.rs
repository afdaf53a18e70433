//! Transition-dependent discounting (paper Eq. 5): full discount on the top k % predicted episodes, sigma times it on
//! the rest.
//!
//! ```text
//! gamma_hat(s, a) = gamma           if (s, a) is in one of the k % of episodes with the highest predicted return
//!                   sigma * gamma   otherwise
//! ```
//!
//! The ranking is stable: between equal predicted returns the earlier episode wins. What decides is
//! [`ted_core::TedDiscount`], the same lookup that the controller uses on an episode it has just flown.
//!
//! Beside it stand other readings of the idea that a low prediction is to be believed: `alternatives.rs` has their equations.

mod alternatives;
#[cfg(test)]
mod inversion;

use serde::{Deserialize, Serialize};
use ted_core::{DiscountClass, DiscountError, NEW_EPISODE, ReturnThreshold, TedDiscount};

use crate::dataset::Dataset;
use crate::ranking::{ranking, share};
use crate::reward::Labels;

/// The choice of a discount rule.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "rule", rename_all = "kebab-case", deny_unknown_fields)]
pub enum DiscountConfig {
    /// The same discount factor everywhere.
    Constant {
        /// The factor, in [0, 1].
        gamma: f32,
        /// Added to every reward: -1 makes a task whose only reward is at its end one of losing no time (IQL on AntMaze). TED has
        /// none, because it makes values negative, and a lower discount would raise them.
        #[serde(default, skip_serializing_if = "is_zero")]
        shift: f32,
    },
    /// TED.
    Ted {
        /// Discount factor of the top k %, in [0, 1].
        gamma: f32,
        /// Share of episodes that keep the full discount factor, in percent.
        k: f64,
        /// Factor on the discount of the others, in [0, 1].
        sigma: f32,
    },
    /// TED by transition: what is ranked is the predicted reward of a transition, not the return of its episode.
    TedTransition {
        /// Discount factor of the top k %, in [0, 1].
        gamma: f32,
        /// Share of transitions that keep the full discount factor, in percent.
        k: f64,
        /// Factor on the discount of the others, in [0, 1].
        sigma: f32,
    },
    /// TED without a border: the discount falls linearly with an episode's place in the ranking.
    TedSoft {
        /// Discount factor of the best episode, in [0, 1].
        gamma: f32,
        /// Factor on the discount of the worst episode, in [0, 1].
        sigma: f32,
    },
    /// TED's episodes with another consequence: below the border rewards are lowered instead of discounts.
    RewardPenalty {
        /// Discount factor of every transition, in [0, 1].
        gamma: f32,
        /// Share of episodes that keep their rewards, in percent.
        k: f64,
        /// Subtracted from each reward of the others, in the unit of the labels; at least 0.
        penalty: f32,
    },
}

/// A run that shifts nothing is configured as ever.
fn is_zero(shift: &f32) -> bool {
    *shift == 0.0
}

/// What an offline algorithm is given for each transition.
#[derive(Clone, Debug, PartialEq)]
pub struct Discounted {
    /// Its reward.
    pub rewards: Vec<f32>,
    /// Its discount factor: 0 after a terminal.
    pub discounts: Vec<f32>,
    /// What discounts came from where a device can repeat it: [`DiscountConfig::lookup`].
    pub lookup: Option<TedDiscount>,
}

impl DiscountConfig {
    /// The paper's TED: k = 70, sigma = 0.7, with IQL's gamma = 0.99.
    pub const TED: Self = Self::Ted {
        gamma: 0.99,
        k: 70.0,
        sigma: 0.7,
    };
    /// TED that lowers nothing: all that is left of it is the border of the best tenth, by which a device tells good episodes
    /// of its own from the others.
    pub const BORDER: Self = Self::Ted {
        gamma: 0.99,
        k: 10.0,
        sigma: 1.0,
    };
    /// The same numbers by transition.
    pub const TED_TRANSITION: Self = Self::TedTransition {
        gamma: 0.99,
        k: 70.0,
        sigma: 0.7,
    };
    /// The same numbers without a border.
    pub const TED_SOFT: Self = Self::TedSoft {
        gamma: 0.99,
        sigma: 0.7,
    };
    /// The same episodes, and as large a share of the rewards' range as TED takes of the discount.
    pub const REWARD_PENALTY: Self = Self::RewardPenalty {
        gamma: 0.99,
        k: 70.0,
        penalty: 0.3,
    };
    /// IQL's constant discount factor.
    pub const CONSTANT: Self = Self::Constant {
        gamma: 0.99,
        shift: 0.0,
    };

    /// The rewards and discounts of every transition, under any rule.
    ///
    /// # Errors
    /// When the rule has a sigma and it or gamma lies outside [0, 1].
    pub fn apply(&self, dataset: &Dataset, labels: &Labels) -> Result<Discounted, DiscountError> {
        let returns_hat = &labels.returns_hat;
        let lookup = self.lookup(returns_hat)?;
        let mut rewards = labels.rewards.clone();
        let discounts = match *self {
            Self::Constant { shift, .. } => {
                rewards.iter_mut().for_each(|reward| *reward += shift);
                self.discounts(lookup.as_ref(), dataset, returns_hat)
            }
            Self::Ted { .. } => self.discounts(lookup.as_ref(), dataset, returns_hat),
            Self::TedTransition { gamma, k, sigma } => {
                let ted = TedDiscount::new(gamma, sigma, ReturnThreshold::<f32>::ALL)?;
                stopped(dataset, alternatives::by_transition(&ted, k, &rewards))
            }
            Self::TedSoft { gamma, sigma } => {
                let ted = TedDiscount::new(gamma, sigma, ReturnThreshold::<f32>::ALL)?;
                let factors = alternatives::soft(&ted, returns_hat);
                stopped(dataset, of_episodes(dataset, &factors))
            }
            Self::RewardPenalty { gamma, k, penalty } => {
                let penalties = alternatives::penalties(k, penalty, returns_hat);
                let penalties = of_episodes(dataset, &penalties);
                rewards.iter_mut().zip(penalties).for_each(|(r, p)| *r -= p);
                stopped(dataset, vec![gamma; dataset.step_count()])
            }
        };
        Ok(Discounted {
            rewards,
            discounts,
            lookup,
        })
    }

    /// The lookup for a dataset with these predicted episode returns. `None` for every rule but TED: a device keeps one sum for
    /// an episode and classes it by that, so it can neither rank a transition's reward nor say anything of an episode that has
    /// no class.
    ///
    /// # Errors
    /// When gamma or sigma lie outside [0, 1].
    pub fn lookup(&self, returns_hat: &[f32]) -> Result<Option<TedDiscount>, DiscountError> {
        let Self::Ted { gamma, k, sigma } = *self else {
            return Ok(None);
        };
        let ends = [ReturnThreshold::<f32>::ALL, ReturnThreshold::<f32>::NONE];
        let threshold = threshold(returns_hat, k, ends, f64::from);
        TedDiscount::new(gamma, sigma, threshold).map(Some)
    }

    /// The border among predicted returns in integer rewards; `None` where there is no lookup.
    #[must_use]
    pub fn integer_threshold(&self, returns_hat: &[i64]) -> Option<ReturnThreshold<i64>> {
        let Self::Ted { k, .. } = *self else {
            return None;
        };
        let ends = [ReturnThreshold::<i64>::ALL, ReturnThreshold::<i64>::NONE];
        Some(threshold(returns_hat, k, ends, |r| r as f64))
    }

    /// One discount factor for each transition by a lookup, or gamma where there is none: what [`Self::apply`] gives for a
    /// constant discount and for TED.
    fn discounts(
        &self,
        lookup: Option<&TedDiscount>,
        dataset: &Dataset,
        returns_hat: &[f32],
    ) -> Vec<f32> {
        let (Self::Constant { gamma, .. }
        | Self::Ted { gamma, .. }
        | Self::TedTransition { gamma, .. }
        | Self::TedSoft { gamma, .. }
        | Self::RewardPenalty { gamma, .. }) = *self;
        let factors = lookup.map_or(vec![gamma; returns_hat.len()], |ted| {
            let classes = classes(ted, returns_hat);
            classes.into_iter().map(|c| ted.discount(c)).collect()
        });
        stopped(dataset, of_episodes(dataset, &factors))
    }
}

/// The number of its episode for each transition.
fn of_episodes(dataset: &Dataset, numbers: &[f32]) -> Vec<f32> {
    let episodes = dataset.episodes().iter().zip(numbers);
    episodes
        .flat_map(|(episode, &number)| std::iter::repeat_n(number, episode.len))
        .collect()
}

/// Discounts that are 0 after a terminal, which alone stops the bootstrap.
fn stopped(dataset: &Dataset, mut discounts: Vec<f32>) -> Vec<f32> {
    for (discount, &end) in discounts.iter_mut().zip(dataset.terminations()) {
        if end {
            *discount = 0.0;
        }
    }
    discounts
}

/// The class of every episode of the dataset, by its predicted return.
#[must_use]
pub fn classes(ted: &TedDiscount, returns_hat: &[f32]) -> Vec<DiscountClass> {
    let class = |(index, &return_hat): (usize, &f32)| {
        ted.class(return_hat, u32::try_from(index).unwrap_or(NEW_EPISODE))
    };
    returns_hat.iter().enumerate().map(class).collect()
}

/// The border of the top `k` percent, rounded to whole episodes. `exact` brings a return to a number that orders as it does:
/// integer returns have far fewer than 53 bits.
fn threshold<R: Copy>(
    returns_hat: &[R],
    k: f64,
    [all, none]: [ReturnThreshold<R>; 2],
    exact: impl Fn(R) -> f64,
) -> ReturnThreshold<R> {
    let keep = share(returns_hat.len(), k);
    if keep >= returns_hat.len() {
        // Also an episode worse than all of these is in then.
        return all;
    }
    let Some(last) = keep.checked_sub(1) else {
        return none;
    };
    let returns: Vec<f64> = returns_hat.iter().copied().map(exact).collect();
    let last = ranking(&returns)[last];
    ReturnThreshold {
        return_hat: returns_hat[last],
        last_tied_episode: u32::try_from(last).unwrap_or(NEW_EPISODE),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::fixtures::{SHAPE, records};

    fn in_top(returns_hat: &[f32], k: f64) -> Vec<usize> {
        let ted = DiscountConfig::Ted {
            gamma: 1.0,
            k,
            sigma: 0.5,
        };
        let ted = ted.lookup(returns_hat).unwrap().unwrap();
        let full = |i: &usize| ted.discount(ted.class(returns_hat[*i], *i as u32)) == 1.0;
        (0..returns_hat.len()).filter(full).collect()
    }

    #[test]
    fn ties_at_the_border_go_to_the_earlier_episode() {
        let returns_hat = [3.0, 1.0, 2.0, 2.0, 2.0, 0.0];
        assert_eq!(in_top(&returns_hat, 50.0), [0, 2, 3]);
    }

    #[test]
    fn exactly_the_share_k_keeps_its_discount() {
        let returns_hat: Vec<f32> = (0..200).map(|i| (i * 37 % 50) as f32).collect();
        for k in [0.0, 0.5, 1.0, 33.0, 70.0, 99.5, 100.0] {
            assert_eq!(
                in_top(&returns_hat, k).len(),
                (2.0 * k).round() as usize,
                "k = {k}"
            );
        }
    }

    #[test]
    fn a_terminal_alone_stops_the_bootstrap_under_both_rules() {
        // Of the three episodes the second ends in a terminal, the others are cut off.
        let dataset = Dataset::from_records("ted/x-v0", SHAPE, &records(&[2, 3, 2])).unwrap();
        let returns_hat = [1.0, 3.0, 2.0];
        let discounts = |config: DiscountConfig| {
            let ted = config.lookup(&returns_hat).unwrap();
            config.discounts(ted.as_ref(), &dataset, &returns_hat)
        };
        let constant = DiscountConfig::Constant {
            gamma: 0.5,
            shift: 0.0,
        };
        let [full, none] = [0.5, 0.0];
        assert_eq!(
            discounts(constant),
            [full, full, full, full, none, full, full]
        );
        let ted = DiscountConfig::Ted {
            gamma: 0.5,
            k: 67.0,
            sigma: 0.5,
        };
        assert_eq!(discounts(ted), [0.25, 0.25, full, full, none, full, full]);
        // Also where the discount is lowered anyway.
        let ted = DiscountConfig::Ted {
            gamma: 0.5,
            k: 0.0,
            sigma: 0.5,
        };
        assert_eq!(discounts(ted), [0.25, 0.25, 0.25, 0.25, none, 0.25, 0.25]);
    }

    #[test]
    fn signed_zeros_do_not_change_who_is_in() {
        assert_eq!(in_top(&[-0.0, 0.0, -0.0, 0.0], 50.0).len(), 2);
    }
}
