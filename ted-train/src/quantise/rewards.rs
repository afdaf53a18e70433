//! The reward ensemble in integers: its networks, and what they say over the whole dataset.
//!
//! The range and TED's border are found as for the floats, from the integers' own predictions: the device reproduces them
//! because it computes the same whole numbers.

use rayon::prelude::*;
use ted_core::integer::{
    IntegerError, IntegerRange, IntegerRewardEnsemble, IntegerScratch, MAX_FRACTION_BITS,
};
use ted_core::quantised::QuantisedRewardEnsemble;
use ted_core::{EpisodeReturn, Mlp, RewardEnsemble, RewardInput};
use ted_policy::Contract;

use super::largest_norm;
use super::network::{
    Calibration, NetworkReport, QuantisedNetwork, input_fraction_bits, output_fraction_bits,
};
use crate::dataset::{Dataset, Episode};

/// A reward ensemble in integers as plain arrays.
#[derive(Clone, Debug, PartialEq)]
pub struct QuantisedRewards {
    members: Vec<QuantisedNetwork>,
    range: IntegerRange,
    /// Predicted return of each episode of the dataset, in integer rewards.
    pub returns_hat: Vec<i64>,
}

impl QuantisedRewards {
    /// Quantises every member on the inputs of these steps, then labels the whole dataset.
    ///
    /// # Errors
    /// When the ensemble was not made for observations and actions of this size.
    pub fn quantise(
        reward: &RewardEnsemble<'_>,
        contract: &Contract<'_>,
        dataset: &Dataset,
        steps: &[usize],
    ) -> Result<(Self, Vec<NetworkReport>), IntegerError> {
        let raw = steps.iter().flat_map(|&step| {
            let action = match reward.input() {
                RewardInput::Observation => &[],
                RewardInput::ObservationAction => dataset.action(step),
            };
            dataset.observation(step).iter().chain(action).copied()
        });
        let calibration = Calibration::new(*reward.normaliser(), raw.collect())?;
        let bits = input_fraction_bits(largest_norm(reward.normaliser(), contract));
        // Outputs are added, so they need one unit: the coarsest fits them all.
        let mut output_bits = MAX_FRACTION_BITS;
        for member in reward.members() {
            output_bits = output_bits.min(output_fraction_bits(member, &calibration)?);
        }
        let members: Vec<_> = (reward.members().iter())
            .map(|member| QuantisedNetwork::quantise(member, &calibration, bits, output_bits))
            .collect::<Result<_, _>>()?;
        let reports = members
            .iter()
            .zip(reward.members())
            .map(|(member, exact): (_, &Mlp<'_>)| member.compare(exact, &calibration))
            .collect::<Result<_, _>>()?;
        let mut rewards = Self {
            members,
            range: IntegerRange { low: 0, high: 0 },
            returns_hat: Vec::new(),
        };
        rewards.label(reward, dataset)?;
        Ok((rewards, reports))
    }

    /// The device's view of it.
    ///
    /// # Errors
    /// When it is larger than the device's limits.
    pub fn view(&self) -> Result<IntegerRewardEnsemble<'_>, IntegerError> {
        let members = self
            .members
            .iter()
            .map(QuantisedNetwork::view)
            .collect::<Result<Vec<_>, _>>()?;
        let (input, output) = self.members.first().map_or((0, 0), |first| {
            (first.input_fraction_bits, first.output_fraction_bits)
        });
        IntegerRewardEnsemble::new(input, output, &members, self.range)
    }

    /// The smallest and the largest sum over the dataset become 0 and 1; then every episode has its return.
    fn label(
        &mut self,
        reward: &RewardEnsemble<'_>,
        dataset: &Dataset,
    ) -> Result<(), IntegerError> {
        let sums = {
            let ensemble =
                QuantisedRewardEnsemble::new(reward.input(), *reward.normaliser(), self.view()?)?;
            let episode = |e: &Episode| {
                let mut scratch = IntegerScratch::new();
                (e.first_step..e.first_step + e.len)
                    .map(|step| {
                        let (obs_raw, action) = (dataset.observation(step), dataset.action(step));
                        ensemble.sum(obs_raw, action, &mut scratch)
                    })
                    .collect::<Result<Vec<i32>, _>>()
            };
            dataset
                .episodes()
                .par_iter()
                .map(episode)
                .collect::<Result<Vec<_>, _>>()?
        };
        self.range = IntegerRange {
            low: sums.iter().flatten().copied().min().unwrap_or(0),
            high: sums.iter().flatten().copied().max().unwrap_or(0),
        };
        self.returns_hat = sums
            .iter()
            .map(|sums| {
                let mut episode = EpisodeReturn::<i64>::default();
                sums.iter()
                    .for_each(|&sum| episode.push(self.range.reward_hat(sum)));
                episode.return_hat()
            })
            .collect();
        Ok(())
    }
}
