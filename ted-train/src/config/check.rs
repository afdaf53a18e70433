//! What the types of a configuration cannot say: which numbers a run could not come to an end with, and which choices do not
//! go together.

mod algorithms;
mod rewards;
mod teacher;

use firmware_sim::counts::EPISODES;

use crate::algorithm::{AlgorithmConfig, ObservationScaling};
use crate::filter::FilterConfig;
use crate::ted::DiscountConfig;

use super::ranges::{Table, as_written};
use super::{Config, ConfigError, Schedule};

impl Config {
    /// Checks what the types cannot say.
    ///
    /// # Errors
    /// Names two choices of which one does not give what the other needs, or the first field that is out of range, its value
    /// and the range.
    pub fn check(&self) -> Result<(), ConfigError> {
        self.composition()?;
        rewards::reward(&self.reward)?;
        filter(&self.filter)?;
        discount(&self.discount)?;
        algorithms::algorithm(&self.algorithm)?;
        let Schedule {
            log_every,
            checkpoint_every,
            evaluation_episodes,
        } = self.schedule;
        let schedule = Table("schedule");
        schedule.at_least_one("log_every", log_every as f64)?;
        schedule.at_least_one("checkpoint_every", checkpoint_every as f64)?;
        let most = *EPISODES.end() as f64;
        schedule.at_most("evaluation_episodes", evaluation_episodes.into(), most)?;
        teacher::teacher(self)
    }

    /// Whether each choice gives what the next one needs, and is needed itself.
    fn composition(&self) -> Result<(), ConfigError> {
        let refuse =
            |choice: &'static str, reason: String| Err(ConfigError::Composition { choice, reason });
        let algorithm = self.algorithm.name();
        let reads_rewards = self.algorithm.reads_rewards();
        if self.reward.is_none() {
            if reads_rewards {
                let reason = format!(
                    "{algorithm} needs a reward for each transition, and reward.source = \"none\" gives none: choose another \
                     source, or the algorithm bc or oppo"
                );
                return refuse("algorithm", reason);
            }
            if matches!(self.filter, FilterConfig::TopPredicted { .. }) {
                let reason = "top-predicted ranks episodes by predicted return, and reward.source = \"none\" predicts none: \
                              choose another source, or filter.keep = \"top-true\""
                    .to_owned();
                return refuse("filter", reason);
            }
        }
        let predicted = matches!(self.filter, FilterConfig::TopPredicted { .. });
        if !reads_rewards && !predicted && !self.reward.is_none() {
            let reason = format!(
                "{algorithm} looks at no reward, and no filter ranks by it, so nothing would come of it: set reward.source = \"none\""
            );
            return refuse("reward", reason);
        }
        if matches!(self.algorithm, AlgorithmConfig::Oppo(_))
            && !matches!(self.filter, FilterConfig::All {})
        {
            let reason = "oppo looks at clips of all episodes, and the answers say which are better: set filter.keep = \"all\""
                .to_owned();
            return refuse("filter", reason);
        }
        if matches!(self.algorithm, AlgorithmConfig::Oppo(_))
            && self.observations != ObservationScaling::Standardised
        {
            let reason =
                "oppo standardises observations itself: set observations = \"standardised\""
                    .to_owned();
            return refuse("observations", reason);
        }
        if let FilterConfig::TopPredicted { k: drawn } = self.filter
            && let DiscountConfig::Ted { k, .. } | DiscountConfig::RewardPenalty { k, .. } =
                self.discount
            && drawn <= k
        {
            let reason = format!(
                "it spares the top {k} % of episodes, and the filter draws from the top {drawn} % only, so nothing would come of it: \
                 set discount.rule = \"constant\", or draw from more"
            );
            return refuse("discount", reason);
        }
        // What is left of TED with a sigma of 1 is a border among the returns of a learned reward, for a device.
        let heard = match self.discount {
            DiscountConfig::Constant { .. } => true,
            DiscountConfig::Ted { sigma, .. } => sigma == 1.0 && self.reward.learner().is_some(),
            _ => false,
        };
        if !self.algorithm.reads_discounts() && !heard {
            let reason = format!(
                "{algorithm} looks at no discount, so nothing would come of a lower one: set discount.rule = \"constant\", or, if a \
                 reward is learned, rule \"ted\" with discount.sigma = 1, which leaves a device the border of the top k % alone"
            );
            return refuse("discount", reason);
        }
        Ok(())
    }
}

fn filter(config: &FilterConfig) -> Result<(), ConfigError> {
    match *config {
        FilterConfig::All {} => Ok(()),
        FilterConfig::TopPredicted { k } | FilterConfig::TopTrue { k } => {
            Table("filter").within("k", k, k > 0.0 && k <= 100.0, "in (0, 100]")
        }
    }
}

fn discount(config: &DiscountConfig) -> Result<(), ConfigError> {
    let table = Table("discount");
    let share = |field, value: f32| table.share(field, as_written(value));
    match *config {
        DiscountConfig::Constant { gamma, shift } => {
            share("gamma", gamma)?;
            table.within("shift", as_written(shift), shift.is_finite(), "finite")
        }
        DiscountConfig::Ted { gamma, k, sigma }
        | DiscountConfig::TedTransition { gamma, k, sigma } => {
            share("gamma", gamma)?;
            share("sigma", sigma)?;
            table.percent("k", k)
        }
        DiscountConfig::TedSoft { gamma, sigma } => {
            share("gamma", gamma)?;
            share("sigma", sigma)
        }
        DiscountConfig::RewardPenalty { gamma, k, penalty } => {
            share("gamma", gamma)?;
            table.not_negative("penalty", as_written(penalty))?;
            table.percent("k", k)
        }
    }
}
