//! What a person wants to know of a dataset before spending a day on it: what every channel does, what a run will make of it, and
//! what is odd.

mod channel;
mod episodes;
mod findings;
#[cfg(test)]
mod tests;

pub use channel::{ActionCheck, Decides, Moves, ObservationCheck};
pub use episodes::EpisodesCheck;
pub use findings::{Finding, Grade, short};

use std::path::Path;

use firmware_sim::robot::Fact;
use serde::Serialize;

use crate::contract::contract;
use crate::dataset::{Dataset, Glitch};
use crate::inspect::DatasetText;

/// All that was found.
#[derive(Clone, Debug, Serialize)]
pub struct Check {
    /// The dataset in short.
    pub dataset: DatasetText,
    /// What is odd, the worst first.
    pub findings: Vec<Finding>,
    /// What its episodes are.
    pub episodes: EpisodesCheck,
    /// Time from one step to the next in microseconds; none where nobody declared it.
    pub period_us: Option<u32>,
    /// Whether somebody declared the robot.
    pub robot_declared: bool,
    /// Channels of an observation.
    pub observations: Vec<ObservationCheck>,
    /// Channels of an action.
    pub actions: Vec<ActionCheck>,
    /// Values that nothing is learned from, in recorded order.
    pub glitches: Vec<GlitchText>,
}

/// A glitch, and how far it is from what is usual.
#[derive(Clone, Debug, Serialize)]
pub struct GlitchText {
    /// Where it is, what was recorded, and what is usual there.
    #[serde(flatten)]
    pub glitch: Glitch,
    /// How far it is from that, in deviations of its channel without glitches; none in a channel that rests.
    pub deviations: Option<f64>,
}

impl Check {
    /// Looks at the dataset at `path`.
    #[must_use]
    pub fn of(dataset: &Dataset, path: &Path) -> Self {
        let contract = contract(dataset);
        let contract = contract.as_ref();
        let statistics = dataset.observation_statistics();
        let (observations, actions) = channel::channels(dataset, &statistics, contract.ok());
        let robot = dataset.robot();
        let timed = !robot.guessed.contains(&Fact::PeriodUs);
        let glitches = dataset.glitches().iter().map(|&glitch| {
            let std = f64::from(statistics.std[glitch.channel]);
            let away = f64::from(glitch.value) - f64::from(glitch.usual);
            GlitchText {
                glitch,
                deviations: (std > 0.0).then(|| away / std),
            }
        });
        let mut check = Self {
            dataset: DatasetText::new(path, dataset),
            findings: Vec::new(),
            episodes: EpisodesCheck::of(dataset),
            period_us: timed.then_some(robot.period_us),
            robot_declared: robot.declared(),
            observations,
            actions,
            glitches: glitches.collect(),
        };
        let unflyable = contract.err().map(ToString::to_string);
        check.findings = findings::findings(&check, unflyable);
        check
    }
}
