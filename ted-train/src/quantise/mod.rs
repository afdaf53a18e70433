//! From a trained policy and reward ensemble to the same networks in integers, with a report of what that costs.
//!
//! ```text
//! input     x = floor(norm * 2^f + 1/2)       f: the most fraction bits with which nothing that the contract accepts is cut off
//! weights   w = round(W / u), |w| <= 127      u per output: its largest weight over 127
//! bias      b = round((B + sum (W - u w) mean(x)) / (unit(x) u))
//! hidden    16 bits for twice the largest activation of the calibration
//! output    12 fraction bits before a tanh, whose table ends at 8
//! ```
//!
//! Calibration is on observations spread evenly over the dataset. No training follows: what 8-bit weights lose is measured,
//! here against the floats and in flight against them (`docs/results.md`).

mod layer;
mod network;
mod report;
mod rewards;
#[cfg(test)]
mod tests;

pub use layer::{IntegerLayer, LayerInput};
pub use network::{Calibration, LayerReport, NetworkReport, QuantisedNetwork};
pub use report::{ActionError, Coarsest, QuantisationReport, RewardReport};
pub use rewards::QuantisedRewards;

use ted_core::integer::{IntegerError, IntegerPolicy, IntegerScratch};
use ted_core::quantised::QuantisedPolicy;
use ted_core::{
    DiscountClass, NEW_EPISODE, Normaliser, Policy, ReturnThreshold, RewardEnsemble, Scratch,
    TedDiscount,
};
use ted_policy::{Contract, IntegerSpec};

use crate::dataset::Dataset;
use crate::ted::{DiscountConfig, classes};

/// Observations that the networks are calibrated on and compared by.
const CALIBRATION: usize = 8192;

/// The networks of a run in integers as plain arrays.
#[derive(Clone, Debug, PartialEq)]
pub struct QuantisedNetworks {
    policy: QuantisedNetwork,
    rewards: Option<QuantisedRewards>,
    threshold: Option<ReturnThreshold<i64>>,
}

/// What is quantised.
#[derive(Clone, Debug)]
pub struct Originals<'a> {
    /// What a controller accepts: the integers have room for all of it.
    pub contract: &'a Contract<'a>,
    /// The policy.
    pub policy: Policy<'a>,
    /// The reward ensemble, if the artefact has one.
    pub reward: Option<RewardEnsemble<'a>>,
    /// TED's lookup, if the artefact has one, and the rule that it follows.
    pub ted: Option<(TedDiscount, &'a DiscountConfig)>,
    /// Predicted returns of the dataset's episodes by the float ensemble, if there is one.
    pub returns_hat: &'a [f32],
}

impl QuantisedNetworks {
    /// Quantises everything of a run, and compares.
    ///
    /// # Errors
    /// When a network was not made for observations and actions of this size.
    pub fn quantise(
        originals: &Originals<'_>,
        dataset: &Dataset,
    ) -> Result<(Self, QuantisationReport), IntegerError> {
        let count = CALIBRATION.min(dataset.step_count());
        let steps: Vec<usize> = (0..count)
            .map(|i| i * dataset.step_count() / count)
            .collect();
        let normaliser = *originals.policy.normaliser();
        let observations: Vec<f32> = (steps.iter())
            .flat_map(|&step| dataset.observation(step).iter().copied())
            .collect();
        let calibration = Calibration::new(normaliser, observations.clone())?;
        let largest = largest_norm(&normaliser, originals.contract);
        let mlp = originals.policy.mlp();
        let bits = network::input_fraction_bits(largest);
        let output_bits = network::output_fraction_bits(mlp, &calibration)?;
        let policy = QuantisedNetwork::quantise(mlp, &calibration, bits, output_bits)?;
        let mut quantised = Self {
            policy,
            rewards: None,
            threshold: None,
        };
        let mut report = QuantisationReport {
            policy: quantised.policy.compare(mlp, &calibration)?,
            input_fraction_bits: bits,
            coarsest: Coarsest::of(&normaliser, bits, originals.contract),
            actions: quantised.action_errors(&originals.policy, &observations)?,
            rewards: None,
        };
        if let Some(reward) = &originals.reward {
            let (rewards, members) =
                QuantisedRewards::quantise(reward, originals.contract, dataset, &steps)?;
            let threshold = originals
                .ted
                .and_then(|(_, rule)| rule.integer_threshold(&rewards.returns_hat));
            report.rewards = Some(RewardReport {
                members,
                class_changes: None,
                episodes: rewards.returns_hat.len(),
            });
            quantised.rewards = Some(rewards);
            quantised.threshold = threshold;
        }
        if let (Some((ted, _)), Some(rewards)) = (originals.ted, &mut report.rewards) {
            let floats = classes(&ted, originals.returns_hat);
            rewards.class_changes = quantised
                .classes()
                .map(|integers| integers.iter().zip(&floats).filter(|(a, b)| a != b).count());
        }
        Ok((quantised, report))
    }

    /// What goes into the artefact.
    ///
    /// # Errors
    /// When the networks are larger than the device's limits.
    pub fn view(&self) -> Result<IntegerSpec<'_>, IntegerError> {
        Ok(IntegerSpec {
            policy: self.policy_view()?,
            reward: (self.rewards.as_ref())
                .map(QuantisedRewards::view)
                .transpose()?,
            threshold: self.threshold,
        })
    }

    /// The class of every episode of the dataset by the integers' own returns and border, if there is one.
    #[must_use]
    pub fn classes(&self) -> Option<Vec<DiscountClass>> {
        let (rewards, threshold) = (self.rewards.as_ref()?, self.threshold?);
        let returns_hat = rewards.returns_hat.iter().enumerate();
        let class = |(index, &return_hat)| {
            threshold.class(return_hat, u32::try_from(index).unwrap_or(NEW_EPISODE))
        };
        Some(returns_hat.map(class).collect())
    }

    fn policy_view(&self) -> Result<IntegerPolicy<'_>, IntegerError> {
        IntegerPolicy::new(
            self.policy.input_fraction_bits,
            self.policy.output_fraction_bits,
            self.policy.view()?,
        )
    }

    fn action_errors(
        &self,
        policy: &Policy<'_>,
        observations: &[f32],
    ) -> Result<Vec<ActionError>, IntegerError> {
        let quantised = QuantisedPolicy::new(*policy.normaliser(), self.policy_view()?)?;
        let (mut scratch, mut integer_scratch) = (Scratch::new(), IntegerScratch::new());
        let mut errors = vec![Vec::new(); policy.action_dim()];
        let mut exact = vec![0.0; policy.action_dim()];
        let mut integer = exact.clone();
        for obs_raw in observations.chunks_exact(policy.observation_dim()) {
            policy.act(obs_raw, &mut scratch, &mut exact)?;
            quantised.act(obs_raw, &mut integer_scratch, &mut integer)?;
            for ((errors, a), b) in errors.iter_mut().zip(&exact).zip(&integer) {
                errors.push(f64::from((a - b).abs()));
            }
        }
        Ok(errors.into_iter().map(ActionError::of).collect())
    }
}

/// The largest magnitude of a standardised value that the contract accepts: of the observation, and of the action if the
/// normaliser has channels for it.
fn largest_norm(normaliser: &Normaliser<'_>, contract: &Contract<'_>) -> f64 {
    let observation = contract.observation.iter().map(|it| [it.low, it.high]);
    // Networks see actions as the policy gives them.
    let action = contract.action.iter().map(|_| [-1.0, 1.0]);
    let statistics = normaliser.shift().iter().zip(normaliser.scale());
    observation
        .chain(action)
        .zip(statistics)
        .flat_map(|(ends, (shift, scale))| ends.map(|raw| f64::from(((raw - shift) * scale).abs())))
        .fold(0.0, f64::max)
}
