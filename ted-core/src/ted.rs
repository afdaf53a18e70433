//! TED's lookup: which discount a transition gets, from the predicted return of its episode.

use core::fmt;

/// Episode number of an episode that is not in the dataset: it loses every tie.
pub const NEW_EPISODE: u32 = u32::MAX;

/// The last episode of the top k %: the border of a ranking by predicted return, ties won by the earlier episode.
///
/// Returns are `f32`, or `i64` where rewards are integers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReturnThreshold<R = f32> {
    /// Predicted return of that episode.
    pub return_hat: R,
    /// Its number in the dataset.
    pub last_tied_episode: u32,
}

impl<R: PartialOrd> ReturnThreshold<R> {
    /// The side of the border on which an episode of this predicted return lies.
    #[must_use]
    pub fn class(&self, return_hat: R, episode: u32) -> DiscountClass {
        let tied = return_hat == self.return_hat;
        if return_hat > self.return_hat || (tied && episode <= self.last_tied_episode) {
            DiscountClass::TopK
        } else {
            DiscountClass::BelowTopK
        }
    }
}

impl ReturnThreshold {
    /// The border that every return passes (k = 100).
    pub const ALL: Self = Self {
        return_hat: f32::MIN,
        last_tied_episode: u32::MAX,
    };
    /// The border that no return passes (k = 0).
    pub const NONE: Self = Self {
        return_hat: f32::MAX,
        last_tied_episode: 0,
    };
}

impl ReturnThreshold<i64> {
    /// The border that every return passes (k = 100).
    pub const ALL: Self = Self {
        return_hat: i64::MIN,
        last_tied_episode: u32::MAX,
    };
    /// The border that no return passes (k = 0).
    pub const NONE: Self = Self {
        return_hat: i64::MAX,
        last_tied_episode: 0,
    };
}

/// On which side of the border an episode lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DiscountClass {
    /// In the top k %: full discount factor.
    TopK,
    /// Below: lowered discount factor, so that its value looks less far.
    BelowTopK,
}

/// A discount that cannot be used.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum DiscountError {
    /// gamma is not in [0, 1].
    Gamma {
        /// What it is.
        actual: f32,
    },
    /// sigma is not in [0, 1].
    Sigma {
        /// What it is.
        actual: f32,
    },
    /// The threshold is not finite.
    Threshold {
        /// What it is.
        actual: f32,
    },
}

impl fmt::Display for DiscountError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Gamma { actual } => {
                write!(f, "discount gamma must lie in [0, 1], found {actual}")
            }
            Self::Sigma { actual } => write!(
                f,
                "discount factor sigma must lie in [0, 1], found {actual}"
            ),
            Self::Threshold { actual } => {
                write!(f, "return threshold must be finite, found {actual}")
            }
        }
    }
}

impl core::error::Error for DiscountError {}

/// The discount of TED (equation 5 of the paper): `gamma` in the top k %, `sigma * gamma` below.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TedDiscount {
    gamma: f32,
    sigma: f32,
    threshold: ReturnThreshold,
}

impl TedDiscount {
    /// Checks and joins the three numbers.
    ///
    /// # Errors
    /// When gamma or sigma lies outside [0, 1] or the threshold is not finite.
    pub fn new(gamma: f32, sigma: f32, threshold: ReturnThreshold) -> Result<Self, DiscountError> {
        if !(0.0..=1.0).contains(&gamma) {
            return Err(DiscountError::Gamma { actual: gamma });
        }
        if !(0.0..=1.0).contains(&sigma) {
            return Err(DiscountError::Sigma { actual: sigma });
        }
        if !threshold.return_hat.is_finite() {
            return Err(DiscountError::Threshold {
                actual: threshold.return_hat,
            });
        }
        Ok(Self {
            gamma,
            sigma,
            threshold,
        })
    }

    /// The full discount factor.
    #[must_use]
    pub fn gamma(&self) -> f32 {
        self.gamma
    }

    /// What the discount factor is multiplied with below the border.
    #[must_use]
    pub fn sigma(&self) -> f32 {
        self.sigma
    }

    /// The border.
    #[must_use]
    pub fn threshold(&self) -> ReturnThreshold {
        self.threshold
    }

    /// The side of the border on which an episode of this predicted return lies.
    #[must_use]
    pub fn class(&self, return_hat: f32, episode: u32) -> DiscountClass {
        self.threshold.class(return_hat, episode)
    }

    /// The discount factor of a class.
    #[must_use]
    pub fn discount(&self, class: DiscountClass) -> f32 {
        match class {
            DiscountClass::TopK => self.gamma,
            DiscountClass::BelowTopK => self.sigma * self.gamma,
        }
    }
}

/// Running predicted return of one episode: an `f32` sum in step order, so that trainer and device get the same bits.
///
/// Where rewards are integers it is an `i64`, and has room for more steps than a device will ever see.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EpisodeReturn<R = f32> {
    sum: R,
}

impl EpisodeReturn {
    /// The return of an episode with no step yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { sum: 0.0 }
    }

    /// Adds the predicted reward of the next step.
    pub fn push(&mut self, reward_hat: f32) {
        self.sum += reward_hat;
    }
}

impl EpisodeReturn<i64> {
    /// Adds the predicted reward of the next step, in the ensemble's own unit.
    pub fn push(&mut self, reward_hat: i32) {
        self.sum = self.sum.saturating_add(i64::from(reward_hat));
    }
}

impl<R: Copy> EpisodeReturn<R> {
    /// The sum so far.
    #[must_use]
    pub fn return_hat(&self) -> R {
        self.sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ted(return_hat: f32, last_tied_episode: u32) -> TedDiscount {
        TedDiscount::new(
            0.99,
            0.7,
            ReturnThreshold {
                return_hat,
                last_tied_episode,
            },
        )
        .unwrap()
    }

    #[test]
    fn a_tie_is_won_by_the_earlier_episode_and_lost_by_a_new_one() {
        let ted = ted(10.0, 4);
        assert_eq!(ted.class(10.0, 3), DiscountClass::TopK);
        assert_eq!(ted.class(10.0, 4), DiscountClass::TopK);
        assert_eq!(ted.class(10.0, 5), DiscountClass::BelowTopK);
        assert_eq!(ted.class(10.0, NEW_EPISODE), DiscountClass::BelowTopK);
    }

    #[test]
    fn without_a_tie_only_the_return_decides() {
        let ted = ted(10.0, 4);
        assert_eq!(
            ted.class(10.0_f32.next_up(), NEW_EPISODE),
            DiscountClass::TopK
        );
        assert_eq!(ted.class(10.0_f32.next_down(), 0), DiscountClass::BelowTopK);
        assert_eq!(ted.class(f32::NAN, 0), DiscountClass::BelowTopK);
    }

    #[test]
    fn the_ends_of_k_let_everything_or_nothing_pass() {
        for return_hat in [-1e30, 0.0, 500.0] {
            let all = TedDiscount::new(0.99, 0.7, ReturnThreshold::<f32>::ALL).unwrap();
            let none = TedDiscount::new(0.99, 0.7, ReturnThreshold::<f32>::NONE).unwrap();
            assert_eq!(all.class(return_hat, NEW_EPISODE), DiscountClass::TopK);
            assert_eq!(none.class(return_hat, 0), DiscountClass::BelowTopK);
        }
    }

    #[test]
    fn sigma_lowers_gamma_below_the_border_and_one_leaves_its_bits() {
        let ted = ted(10.0, 4);
        assert_eq!(ted.discount(DiscountClass::TopK), 0.99);
        assert_eq!(ted.discount(DiscountClass::BelowTopK), 0.7 * 0.99);
        let plain = TedDiscount::new(0.99, 1.0, ReturnThreshold::<f32>::NONE).unwrap();
        assert_eq!(
            plain.discount(DiscountClass::BelowTopK).to_bits(),
            0.99_f32.to_bits()
        );
    }

    #[test]
    fn numbers_out_of_range_are_refused() {
        let threshold = ReturnThreshold {
            return_hat: 0.0,
            last_tied_episode: 0,
        };
        for bad in [-0.1, 1.1, f32::NAN, f32::INFINITY] {
            assert!(matches!(
                TedDiscount::new(bad, 0.7, threshold),
                Err(DiscountError::Gamma { .. })
            ));
            assert!(matches!(
                TedDiscount::new(0.9, bad, threshold),
                Err(DiscountError::Sigma { .. })
            ));
        }
        let threshold = ReturnThreshold {
            return_hat: f32::NAN,
            last_tied_episode: 0,
        };
        assert!(matches!(
            TedDiscount::new(0.9, 0.7, threshold),
            Err(DiscountError::Threshold { .. })
        ));
    }

    #[test]
    fn returns_in_integers_are_ranked_by_the_same_rule() {
        let border = ReturnThreshold {
            return_hat: 1_i64 << 40,
            last_tied_episode: 4,
        };
        assert_eq!(border.class(1 << 40, 4), DiscountClass::TopK);
        assert_eq!(border.class(1 << 40, 5), DiscountClass::BelowTopK);
        assert_eq!(
            border.class((1 << 40) + 1, NEW_EPISODE),
            DiscountClass::TopK
        );
        let mut episode = EpisodeReturn::<i64>::default();
        for _ in 0..3 {
            episode.push(i32::MAX);
        }
        assert_eq!(episode.return_hat(), 3 * i64::from(i32::MAX));
    }

    #[test]
    fn an_episode_return_is_the_sum_in_step_order() {
        let mut episode = EpisodeReturn::new();
        for reward_hat in [1e8, 1.0, -1e8] {
            episode.push(reward_hat);
        }
        assert_eq!(episode.return_hat(), (1e8_f32 + 1.0) - 1e8);
    }
}
