//! Other readings of TED, to be compared with it: by transition, without a border, and as a penalty on rewards.
//!
//! ```text
//! by transition   gamma_hat = gamma if r_hat is among the k % highest of all transitions, else sigma gamma
//! soft            gamma_hat = gamma (1 - (1 - sigma) (1 - q)),    q the quantile of the episode's predicted return
//! penalty         r_hat     = r_hat - penalty if the episode is not among the top k %;    gamma_hat = gamma
//! ```
//!
//! Ranks and ties are TED's: what is recorded earlier wins. In the soft rule, where nobody wins, episodes of equal return share
//! their mean place, and `q` is 1 for the best episode and 0 for the worst, linear in the place between them: the simplest
//! function that rises from `sigma gamma` to `gamma`, with nothing more to choose.
//!
//! `sigma = 1`, a penalty of 0 and `k = 100` each leave a constant discount, to the bit.

use ted_core::{DiscountClass, TedDiscount};

use crate::ranking::{ranking, ranks, share};

/// A discount factor for each transition, by its own predicted reward.
pub(super) fn by_transition(ted: &TedDiscount, k: f64, rewards_hat: &[f32]) -> Vec<f32> {
    let below = ted.discount(DiscountClass::BelowTopK);
    top_or(ted.gamma(), below, k, rewards_hat)
}

/// A discount factor for each episode, by the quantile of its predicted return.
pub(super) fn soft(ted: &TedDiscount, returns_hat: &[f32]) -> Vec<f32> {
    let last = returns_hat.len().saturating_sub(1).max(1) as f64;
    let (gamma, sigma) = (f64::from(ted.gamma()), f64::from(ted.sigma()));
    // In double precision both ends come out exactly.
    let factor = |rank: f64| (gamma * (1.0 - (1.0 - sigma) * (rank / last))) as f32;
    ranks(&wide(returns_hat)).into_iter().map(factor).collect()
}

/// What is subtracted from the rewards of each episode.
pub(super) fn penalties(k: f64, penalty: f32, returns_hat: &[f32]) -> Vec<f32> {
    top_or(0.0, penalty, k, returns_hat)
}

/// One number for the top k % and another for the others.
fn top_or(top: f32, others: f32, k: f64, predictions: &[f32]) -> Vec<f32> {
    let mut numbers = vec![others; predictions.len()];
    let keep = share(predictions.len(), k);
    for index in ranking(&wide(predictions)).into_iter().take(keep) {
        numbers[index] = top;
    }
    numbers
}

fn wide(values: &[f32]) -> Vec<f64> {
    values.iter().copied().map(f64::from).collect()
}

#[cfg(test)]
mod tests {
    use crate::dataset::Dataset;
    use crate::dataset::fixtures::{SHAPE, records};
    use crate::reward::Labels;
    use crate::ted::{DiscountConfig, Discounted};

    /// Episodes of 2, 3 and 2 steps, of which the second ends in a terminal. Predicted returns: 0.5, 1.5 and 1.
    const REWARDS: [f32; 7] = [0.5, 0.0, 0.25, 0.75, 0.5, 0.125, 0.875];

    fn dataset() -> Dataset {
        Dataset::from_records("ted/x-v0", SHAPE, &records(&[2, 3, 2])).unwrap()
    }

    fn labels() -> Labels {
        Labels::raw(&dataset(), REWARDS.to_vec())
    }

    fn applied(config: &DiscountConfig) -> Discounted {
        config.apply(&dataset(), &labels()).unwrap()
    }

    #[test]
    fn by_transition_the_highest_predicted_rewards_keep_their_discount_wherever_they_are() {
        let config = DiscountConfig::TedTransition {
            gamma: 0.5,
            k: 43.0,
            sigma: 0.5,
        };
        let Discounted {
            rewards, discounts, ..
        } = applied(&config);
        assert_eq!(rewards, REWARDS);
        // Three of seven: 0.875, 0.75, and of the two halves the earlier one.
        let [full, low, none] = [0.5, 0.25, 0.0];
        assert_eq!(discounts, [full, low, low, full, none, low, full]);
    }

    #[test]
    fn softly_the_discount_is_linear_in_the_place_of_the_episode() {
        let config = DiscountConfig::TedSoft {
            gamma: 0.5,
            sigma: 0.5,
        };
        let Discounted {
            rewards, discounts, ..
        } = applied(&config);
        assert_eq!(rewards, REWARDS);
        let [best, middle, worst, none] = [0.5, 0.375, 0.25, 0.0];
        assert_eq!(discounts, [worst, worst, best, best, none, middle, middle]);
    }

    #[test]
    fn softly_the_ends_are_those_of_ted_and_equal_episodes_share_a_discount() {
        for (gamma, sigma) in [(0.99, 0.7), (0.99, 0.1), (0.97, 1.0), (0.9, 0.0)] {
            let soft = |returns_hat: &[f32]| {
                let all = ted_core::ReturnThreshold::<f32>::ALL;
                let ted = ted_core::TedDiscount::new(gamma, sigma, all).unwrap();
                super::soft(&ted, returns_hat)
            };
            let ends = soft(&[3.0, 1.0, 2.0]);
            assert_eq!([ends[0], ends[1]], [gamma, sigma * gamma]);
            let tied = soft(&[2.0, 5.0, 2.0, 1.0, -0.0, 0.0]);
            assert_eq!((tied[0], tied[4]), (tied[2], tied[5]));
            assert_eq!(soft(&[4.0]), [gamma], "alone it is the best");
        }
    }

    #[test]
    fn a_penalty_lowers_the_rewards_of_the_episodes_that_ted_would_discount() {
        let (gamma, k) = (0.5, 67.0);
        let penalty = 0.25;
        let Discounted {
            rewards, discounts, ..
        } = applied(&DiscountConfig::RewardPenalty { gamma, k, penalty });
        assert_eq!(rewards[..2], [0.25, -0.25]);
        assert_eq!(rewards[2..], REWARDS[2..]);
        assert_eq!(discounts, [0.5, 0.5, 0.5, 0.5, 0.0, 0.5, 0.5]);
        let ted = applied(&DiscountConfig::Ted {
            gamma,
            k,
            sigma: 0.5,
        });
        assert_eq!(ted.discounts, [0.25, 0.25, 0.5, 0.5, 0.0, 0.5, 0.5]);
    }

    #[test]
    fn without_a_consequence_every_rule_is_the_constant_discount_to_the_bit() {
        let bits = |config: DiscountConfig| {
            let Discounted {
                rewards, discounts, ..
            } = applied(&config);
            let bits = |values: Vec<f32>| values.into_iter().map(f32::to_bits).collect::<Vec<_>>();
            (bits(rewards), bits(discounts))
        };
        let constant = bits(DiscountConfig::CONSTANT);
        let (gamma, half) = (0.99, 50.0);
        for (k, sigma) in [(half, 1.0), (100.0, 0.7)] {
            assert_eq!(bits(DiscountConfig::Ted { gamma, k, sigma }), constant);
            let by_transition = DiscountConfig::TedTransition { gamma, k, sigma };
            assert_eq!(bits(by_transition), constant);
        }
        let sigma = 1.0;
        assert_eq!(bits(DiscountConfig::TedSoft { gamma, sigma }), constant);
        for (k, penalty) in [(half, 0.0), (100.0, 0.5)] {
            let penalised = DiscountConfig::RewardPenalty { gamma, k, penalty };
            assert_eq!(bits(penalised), constant);
        }
    }

    #[test]
    fn only_ted_itself_has_a_lookup_for_a_device() {
        let (gamma, k, sigma, penalty) = (0.99, 70.0, 0.7, 0.1);
        let returns_hat = [1.0, 2.0];
        for rule in [
            DiscountConfig::TedTransition { gamma, k, sigma },
            DiscountConfig::TedSoft { gamma, sigma },
            DiscountConfig::RewardPenalty { gamma, k, penalty },
        ] {
            assert_eq!(rule.lookup(&returns_hat), Ok(None));
            assert_eq!(rule.integer_threshold(&[1, 2]), None);
        }
        assert!(DiscountConfig::TED.lookup(&returns_hat).unwrap().is_some());
    }

    #[test]
    fn a_sigma_or_gamma_out_of_range_is_refused_under_every_rule_that_has_one() {
        let refused = |rule: DiscountConfig| rule.apply(&dataset(), &labels()).unwrap_err();
        let k = 50.0;
        let (gamma, sigma) = (0.99, 1.5);
        let error = ted_core::DiscountError::Sigma { actual: sigma };
        assert_eq!(refused(DiscountConfig::Ted { gamma, k, sigma }), error);
        assert_eq!(
            refused(DiscountConfig::TedTransition { gamma, k, sigma }),
            error
        );
        assert_eq!(refused(DiscountConfig::TedSoft { gamma, sigma }), error);
    }

    #[test]
    fn the_rules_are_written_and_read_as_toml() {
        let (gamma, k, sigma, penalty) = (0.5, 70.0, 0.25, 0.125);
        for (rule, text) in [
            (
                DiscountConfig::TedTransition { gamma, k, sigma },
                "rule = \"ted-transition\"\ngamma = 0.5\nk = 70.0\nsigma = 0.25\n",
            ),
            (
                DiscountConfig::TedSoft { gamma, sigma },
                "rule = \"ted-soft\"\ngamma = 0.5\nsigma = 0.25\n",
            ),
            (
                DiscountConfig::RewardPenalty { gamma, k, penalty },
                "rule = \"reward-penalty\"\ngamma = 0.5\nk = 70.0\npenalty = 0.125\n",
            ),
        ] {
            assert_eq!(toml::to_string(&rule).unwrap(), text);
            assert_eq!(toml::from_str::<DiscountConfig>(text).unwrap(), rule);
        }
    }
}
