//! A dataset in memory: every array contiguous over all episodes, with the maps between steps, rows and episodes.

use super::minari::Origin;
use super::{DatasetError, EpisodeRecord, Glitch, ObservationStatistics, Shape, assemble};
use firmware_sim::robot::Robot;
use std::path::Path;

/// One episode's place in the arrays, and what it came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Episode {
    /// Index of its first step in the step arrays.
    pub first_step: usize,
    /// Number of steps.
    pub len: usize,
    /// The seed the environment was reset with, where known.
    pub seed: Option<u64>,
    /// Sum of the true rewards in double precision, as recorded.
    pub return_true: f64,
    /// Whether the task was solved at any step; false where the dataset does not say.
    pub success: bool,
}

/// An offline dataset, immutable once built: its existence says that shapes agree, that every number is finite, and that
/// actions lie in the ranges of its robot.
#[derive(Clone, Debug)]
pub struct Dataset {
    pub(super) id: String,
    pub(super) origin: Option<Origin>,
    pub(super) digest: String,
    pub(super) robot: Robot,
    pub(super) shape: Shape,
    pub(super) episodes: Vec<Episode>,
    pub(super) row_of_step: Vec<u32>,
    pub(super) observations: Vec<f32>,
    pub(super) glitches: Vec<Glitch>,
    /// In [-1, 1].
    pub(super) actions: Vec<f32>,
    /// As recorded, where that is not the same.
    pub(super) actions_env: Option<Vec<f32>>,
    pub(super) rewards_true: Vec<f32>,
    pub(super) terminations: Vec<bool>,
    pub(super) truncations: Vec<bool>,
    pub(super) success: Vec<bool>,
}

impl Dataset {
    /// Reads the Minari dataset at `path`: its own folder (`.../name-v0`) or the `data` folder inside it.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, DatasetError> {
        super::minari::read(path.as_ref(), None)
    }

    /// Reads the dataset at `path` as one of this robot, whatever it says itself.
    pub fn open_as(path: impl AsRef<Path>, robot: Robot) -> Result<Self, DatasetError> {
        super::minari::read(path.as_ref(), Some(robot))
    }

    /// Builds a dataset from episodes in memory, of a robot that nobody declared and whose actions lie in [-1, 1].
    pub fn from_records(
        id: &str,
        shape: Shape,
        records: &[EpisodeRecord],
    ) -> Result<Self, DatasetError> {
        let robot = Robot::draft(shape.observation, &vec![[-1.0, 1.0]; shape.action]);
        Self::of_robot(id, robot, records)
    }

    /// Builds a dataset from episodes of this robot in memory.
    pub fn of_robot(
        id: &str,
        robot: Robot,
        records: &[EpisodeRecord],
    ) -> Result<Self, DatasetError> {
        assemble::from_records(id, robot, records)
    }

    /// `namespace/name-vN`.
    #[must_use]
    pub fn id(&self) -> &str {
        &self.id
    }

    /// BLAKE3 of observations, actions, rewards and all flags in canonical order, in hexadecimal: two datasets with this in
    /// common are the same to whoever learns from them. Other infos, such as the simulator's state, may differ.
    #[must_use]
    pub fn digest(&self) -> &str {
        &self.digest
    }

    /// The task that was recorded; none where the dataset was not written by this project.
    #[must_use]
    pub fn task(&self) -> Option<&str> {
        self.origin.as_ref().map(|origin| origin.task.as_str())
    }

    /// How the dataset was collected; none where it was not written by this project.
    #[must_use]
    pub fn origin(&self) -> Option<&Origin> {
        self.origin.as_ref()
    }

    /// The robot that was recorded, declared or not.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// The episodes in recorded order.
    #[must_use]
    pub fn episodes(&self) -> &[Episode] {
        &self.episodes
    }

    /// Numbers in one observation.
    #[must_use]
    pub fn observation_dim(&self) -> usize {
        self.shape.observation
    }

    /// Numbers in one action.
    #[must_use]
    pub fn action_dim(&self) -> usize {
        self.shape.action
    }

    /// Number of steps over all episodes.
    #[must_use]
    pub fn step_count(&self) -> usize {
        self.rewards_true.len()
    }

    /// Row of [`Self::observations`] that `step` acted on.
    #[must_use]
    pub fn observations_row(&self, step: usize) -> usize {
        self.row_of_step[step] as usize
    }

    /// Row of [`Self::observations`] that `step` led to.
    #[must_use]
    pub fn next_observations_row(&self, step: usize) -> usize {
        self.observations_row(step) + 1
    }

    /// The observation that `step` acted on.
    #[must_use]
    pub fn observation(&self, step: usize) -> &[f32] {
        row(
            &self.observations,
            self.observations_row(step),
            self.shape.observation,
        )
    }

    /// The observation that `step` led to.
    #[must_use]
    pub fn next_observation(&self, step: usize) -> &[f32] {
        row(
            &self.observations,
            self.next_observations_row(step),
            self.shape.observation,
        )
    }

    /// The action of `step`, in [-1, 1].
    #[must_use]
    pub fn action(&self, step: usize) -> &[f32] {
        row(&self.actions, step, self.shape.action)
    }

    /// All observations, `(steps + episodes) x observation_dim`, row-major: those that are learned from, with the usual value in
    /// place of each glitch.
    #[must_use]
    pub fn observations(&self) -> &[f32] {
        &self.observations
    }

    /// The values of observations that nothing is learned from, in recorded order.
    #[must_use]
    pub fn glitches(&self) -> &[Glitch] {
        &self.glitches
    }

    /// The observations of an episode as they were recorded, glitches and all, `(steps + 1) x observation_dim`.
    #[must_use]
    pub fn observations_recorded(&self, episode: usize) -> Vec<f32> {
        let width = self.shape.observation;
        let Episode {
            first_step, len, ..
        } = self.episodes[episode];
        let first = (first_step + episode) * width;
        let mut recorded = self.observations[first..first + (len + 1) * width].to_vec();
        for glitch in self.glitches.iter().filter(|it| it.episode == episode) {
            recorded[glitch.step * width + glitch.channel] = glitch.value;
        }
        recorded
    }

    /// All actions, in [-1, 1], `steps x action_dim`, row-major.
    #[must_use]
    pub fn actions(&self) -> &[f32] {
        &self.actions
    }

    /// The action of `step` as it was recorded, in the robot's units.
    #[must_use]
    pub fn action_env(&self, step: usize) -> &[f32] {
        row(self.actions_env(), step, self.shape.action)
    }

    /// All actions as they were recorded, in the robot's units, `steps x action_dim`, row-major.
    #[must_use]
    pub fn actions_env(&self) -> &[f32] {
        self.actions_env.as_ref().unwrap_or(&self.actions)
    }

    /// The true reward of every step.
    #[must_use]
    pub fn rewards_true(&self) -> &[f32] {
        &self.rewards_true
    }

    /// The reward of every step, where it is the same for all: such rewards say of nothing that it is better.
    #[must_use]
    pub fn only_reward(&self) -> Option<f32> {
        let (&first, rest) = self.rewards_true.split_first()?;
        rest.iter().all(|&reward| reward == first).then_some(first)
    }

    /// Where the task ended: only here does the bootstrap stop.
    #[must_use]
    pub fn terminations(&self) -> &[bool] {
        &self.terminations
    }

    /// Where only the recording ended.
    #[must_use]
    pub fn truncations(&self) -> &[bool] {
        &self.truncations
    }

    /// Where the task counted as solved; all false where the dataset does not say.
    #[must_use]
    pub fn success(&self) -> &[bool] {
        &self.success
    }

    /// Mean of the episodes' true returns.
    #[must_use]
    pub fn mean_return_true(&self) -> f64 {
        self.episodes
            .iter()
            .map(|episode| episode.return_true)
            .sum::<f64>()
            / self.episodes.len() as f64
    }

    /// Largest true return of an episode: the denominator of the normalised score.
    #[must_use]
    pub fn max_return_true(&self) -> f64 {
        self.episodes
            .iter()
            .map(|episode| episode.return_true)
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// Mean, standard deviation and range of every observation dimension over all rows, with the usual value in place of each
    /// glitch, and the deviation that each has at least.
    #[must_use]
    pub fn observation_statistics(&self) -> ObservationStatistics {
        ObservationStatistics::of(&self.observations, self.shape.observation, |channel| {
            self.resolution(channel)
        })
    }

    /// The smallest difference that means anything in an observation channel, in its unit; none where nobody declared one.
    #[must_use]
    pub fn resolution(&self, channel: usize) -> Option<f32> {
        self.robot.observation.get(channel)?.resolution
    }
}

fn row(values: &[f32], row: usize, width: usize) -> &[f32] {
    &values[row * width..(row + 1) * width]
}
