//! What the controller may expect and promise: names, units and ranges of the channels of a dataset.

use firmware_sim::plants::metaworld;
use firmware_sim::plants::toy::{self, Units};
use ted_policy::{ActionChannel, Contract, ContractFault, ObservationChannel, SafeAction};

use crate::dataset::Dataset;

/// An observation that missed one tick may still be acted on; one that missed this many may not.
const TOO_OLD_TICKS: u32 = 2;

/// A channel may leave the dataset's range by this share of its width ...
const RANGE_MARGIN: f32 = 0.5;

/// ... and at least by this much, in the channel's unit, so that a channel that never moved can.
const RANGE_FLOOR: f32 = 0.02;

/// Numbers in an observation and in an action of Meta-World.
const META_WORLD: (usize, usize) = (39, 4);

/// Owned names and ranges, from which the artefact's contract borrows.
pub struct ContractText {
    task: String,
    period_us: u32,
    observation: Vec<(String, &'static str, f32, f32)>,
    action: Vec<(String, &'static str, SafeAction)>,
}

impl ContractText {
    /// Names the channels of Meta-World, numbers those of other tasks, and widens the dataset's ranges: beyond them the
    /// policy has never seen anything.
    #[must_use]
    pub fn new(dataset: &Dataset) -> Self {
        let statistics = dataset.observation_statistics();
        let observation = statistics
            .min
            .iter()
            .zip(&statistics.max)
            .enumerate()
            .map(|(i, (&low, &high))| {
                let margin = (RANGE_MARGIN * (high - low)).max(RANGE_FLOOR);
                let (name, unit) = channel_text(i, dataset.observation_dim());
                (name, unit, low - margin, high + margin)
            })
            .collect();
        let action = match (dataset.observation_dim(), dataset.action_dim()) {
            META_WORLD => [
                ("hand_dx", "cm", SafeAction::Zero),
                ("hand_dy", "cm", SafeAction::Zero),
                ("hand_dz", "cm", SafeAction::Zero),
                // Letting go of what it holds is not safe.
                ("gripper", "effort", SafeAction::HoldLast),
            ]
            .map(|(name, unit, on_fault)| (name.to_owned(), unit, on_fault))
            .to_vec(),
            (_, dims) => (0..dims)
                .map(|i| (format!("action_{i}"), "", SafeAction::Zero))
                .collect(),
        };
        let task = dataset.task().unwrap_or("unknown");
        Self {
            task: task.to_owned(),
            period_us: match Units::of_task(task) {
                Some(_) => toy::CONTROL_PERIOD_US,
                None => metaworld::CONTROL_PERIOD_US,
            },
            observation,
            action,
        }
    }

    /// The contract.
    ///
    /// # Errors
    /// When there are more channels than the controller has room for, or a range is not finite.
    pub fn contract(&self) -> Result<Contract<'_>, ContractFault> {
        let observation: Vec<_> = self
            .observation
            .iter()
            .map(|(name, unit, low, high)| ObservationChannel {
                name: name.as_str().into(),
                unit: (*unit).into(),
                low: *low,
                high: *high,
            })
            .collect();
        // A policy trained without a slew limit flies without one: the full range in one tick.
        let action: Vec<_> = self
            .action
            .iter()
            .map(|(name, unit, on_fault)| ActionChannel {
                name: name.as_str().into(),
                unit: (*unit).into(),
                low: -1.0,
                high: 1.0,
                slew_per_tick: 2.0,
                on_fault: *on_fault,
            })
            .collect();
        Contract::new(
            &self.task,
            &observation,
            &action,
            self.period_us,
            TOO_OLD_TICKS * self.period_us,
        )
    }
}

/// Name and unit of an observation channel. Meta-World's 39: 18 of now, 18 of the tick before, and the goal.
#[must_use]
pub fn channel_text(index: usize, dims: usize) -> (String, &'static str) {
    const FRAME: [(&str, &str); 18] = [
        ("hand_x", "m"),
        ("hand_y", "m"),
        ("hand_z", "m"),
        ("gripper_opening", "1"),
        ("object1_x", "m"),
        ("object1_y", "m"),
        ("object1_z", "m"),
        ("object1_qx", "1"),
        ("object1_qy", "1"),
        ("object1_qz", "1"),
        ("object1_qw", "1"),
        ("object2_x", "m"),
        ("object2_y", "m"),
        ("object2_z", "m"),
        ("object2_qx", "1"),
        ("object2_qy", "1"),
        ("object2_qz", "1"),
        ("object2_qw", "1"),
    ];
    const GOAL: [&str; 3] = ["goal_x", "goal_y", "goal_z"];
    match (dims, index) {
        (39, 0..18) => (FRAME[index].0.to_owned(), FRAME[index].1),
        (39, 18..36) => (
            format!("previous_{}", FRAME[index - 18].0),
            FRAME[index - 18].1,
        ),
        (39, 36..39) => (GOAL[index - 36].to_owned(), "m"),
        _ => (format!("observation_{index}"), ""),
    }
}
