//! What quantisation cost, for the person who exports.

use std::fmt::{self, Display};

use serde::{Deserialize, Serialize};
use ted_core::Normaliser;
use ted_core::quantised::resolution;

use super::network::NetworkReport;
use ted_policy::Contract;

/// Where a position in metres is resolved too coarsely: a tenth of a millimetre.
const COARSE_MM: f64 = 0.1;

/// How the integers of an artefact differ from its floats.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct QuantisationReport {
    /// The policy, layer by layer.
    pub policy: NetworkReport,
    /// Fraction bits of a standardised observation.
    pub input_fraction_bits: u8,
    /// The position that is resolved least.
    pub coarsest: Option<Coarsest>,
    /// Differences of the actions, one per channel.
    pub actions: Vec<ActionError>,
    /// The reward ensemble, if there is one.
    pub rewards: Option<RewardReport>,
}

/// A channel in metres, and how finely the integers see it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Coarsest {
    /// Its name.
    pub channel: String,
    /// One unit in the last place, in millimetres.
    pub resolution_mm: f64,
}

/// Absolute differences of one action channel over the calibration observations; the whole range is 2.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ActionError {
    /// Their mean.
    pub mean: f64,
    /// The 99th percentile.
    pub p99: f64,
    /// The largest.
    pub max: f64,
}

/// The reward ensemble in integers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RewardReport {
    /// Its members, layer by layer.
    pub members: Vec<NetworkReport>,
    /// Episodes of the dataset on the other side of TED's border, if the run used TED.
    pub class_changes: Option<usize>,
    /// Episodes of the dataset.
    pub episodes: usize,
}

impl Coarsest {
    pub(super) fn of(
        normaliser: &Normaliser<'_>,
        fraction_bits: u8,
        contract: &Contract<'_>,
    ) -> Option<Self> {
        (contract.observation.iter().zip(normaliser.scale()))
            .filter_map(|(channel, &scale)| {
                let resolution_mm = 1e3 * f64::from(resolution(scale, fraction_bits));
                (channel.unit.as_bytes() == b"m").then(|| Self {
                    channel: channel.name.to_string(),
                    resolution_mm,
                })
            })
            .max_by(|a, b| a.resolution_mm.total_cmp(&b.resolution_mm))
    }
}

impl ActionError {
    pub(super) fn of(mut errors: Vec<f64>) -> Self {
        errors.sort_by(f64::total_cmp);
        let count = errors.len().max(1);
        Self {
            mean: errors.iter().sum::<f64>() / count as f64,
            p99: errors.get(count * 99 / 100).copied().unwrap_or(0.0),
            max: errors.last().copied().unwrap_or(0.0),
        }
    }
}

impl Display for QuantisationReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "integers         {} fraction bits in, {} of {} values of the calibration observations cut off",
            self.input_fraction_bits, self.policy.saturated_inputs, self.policy.inputs
        )?;
        if let Some(Coarsest {
            channel,
            resolution_mm,
        }) = &self.coarsest
        {
            write!(
                f,
                "\nresolution       {resolution_mm:.3} mm or finer ({channel}){}",
                if *resolution_mm > COARSE_MM {
                    ": coarser than a controller of positions wants"
                } else {
                    ""
                }
            )?;
        }
        for (index, layer) in self.policy.layers.iter().enumerate() {
            write!(
                f,
                "\nlayer {index}          relative error {:.4}, {} values cut off",
                layer.relative_error, layer.saturated
            )?;
        }
        for (index, action) in self.actions.iter().enumerate() {
            write!(
                f,
                "\naction {index}         off by {:.4} on average, {:.4} at the 99th percentile, {:.4} at most",
                action.mean, action.p99, action.max
            )?;
        }
        if let Some(rewards) = &self.rewards {
            let layers = || rewards.members.iter().flat_map(|member| &member.layers);
            let worst = layers().fold(0.0, |worst, layer| f64::max(worst, layer.relative_error));
            let cut_off = layers().map(|layer| layer.saturated).sum::<usize>()
                + (rewards.members.first()).map_or(0, |member| member.saturated_inputs);
            write!(
                f,
                "\nreward ensemble  {} members, relative error of a layer at most {worst:.4}, {cut_off} values cut off",
                rewards.members.len()
            )?;
            if let Some(changes) = rewards.class_changes {
                write!(
                    f,
                    "; {changes} of {} episodes on the other side of TED's border",
                    rewards.episodes
                )?;
            }
        }
        Ok(())
    }
}
