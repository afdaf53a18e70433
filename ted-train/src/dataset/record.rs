//! One recorded episode as owned arrays: what a collector hands to the writer and a test hands to [`super::Dataset`].

use firmware_sim::robot::Robot;

use super::DatasetError;

/// Widths of one observation row and one action row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Numbers in one observation.
    pub observation: usize,
    /// Numbers in one action.
    pub action: usize,
}

impl Shape {
    /// Those of a robot's numbers.
    #[must_use]
    pub fn of(robot: &Robot) -> Self {
        Self {
            observation: robot.observation.len(),
            action: robot.action.len(),
        }
    }
}

/// An episode of `T` steps: `T + 1` observations, `T` of everything else.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EpisodeRecord {
    /// The seed the environment was reset with, where there was one.
    pub seed: Option<u64>,
    /// `(T + 1) x observation` values, row-major.
    pub observations: Vec<f32>,
    /// `T x action` values, row-major, exactly as executed.
    pub actions: Vec<f32>,
    /// True reward of each step.
    pub rewards: Vec<f64>,
    /// Whether the task ended at this step.
    pub terminations: Vec<bool>,
    /// Whether the recording ended at this step.
    pub truncations: Vec<bool>,
    /// Whether the task counted as solved after this step.
    pub success: Vec<bool>,
    /// Further columns of `T + 1` rows, such as the simulator state.
    pub infos: Vec<InfoColumn>,
}

/// One named column of simulator state, `T + 1` rows.
#[derive(Clone, Debug, PartialEq)]
pub struct InfoColumn {
    /// Name under `infos`, such as `qpos`.
    pub name: String,
    /// Numbers in one row.
    pub width: usize,
    /// `(T + 1) x width` values, row-major.
    pub values: Vec<f64>,
}

impl EpisodeRecord {
    /// Number of steps `T`.
    #[must_use]
    pub fn steps(&self) -> usize {
        self.rewards.len()
    }

    /// Undiscounted sum of the true rewards, in step order.
    #[must_use]
    pub fn return_true(&self) -> f64 {
        self.rewards.iter().sum()
    }

    /// Whether the task was solved at any step.
    #[must_use]
    pub fn succeeded(&self) -> bool {
        self.success.iter().any(|&solved| solved)
    }

    /// Checks that every array has the length the episode and the robot ask for, that what is learned from is finite, and that actions
    /// lie in their ranges; `place` names the episode in the error.
    pub fn check(&self, robot: &Robot, place: &str) -> Result<(), DatasetError> {
        let shape = Shape::of(robot);
        let steps = self.steps();
        if steps == 0 {
            return Err(DatasetError::EmptyEpisode {
                place: place.into(),
            });
        }
        let rows = steps + 1;
        let lengths = [
            (
                "observations",
                self.observations.len(),
                rows * shape.observation,
            ),
            ("actions", self.actions.len(), steps * shape.action),
            ("terminations", self.terminations.len(), steps),
            ("truncations", self.truncations.len(), steps),
            ("success", self.success.len(), steps),
        ];
        let infos = self
            .infos
            .iter()
            .map(|info| (info.name.as_str(), info.values.len(), rows * info.width));
        for (array, actual, expected) in lengths.into_iter().chain(infos) {
            if actual != expected {
                return Err(DatasetError::WrongShape {
                    place: place.into(),
                    array: array.into(),
                    expected: format!("{expected} values for {steps} steps"),
                    actual: format!("{actual}"),
                });
            }
        }
        let rewards: Vec<f32> = self.rewards.iter().map(|&reward| reward as f32).collect();
        check_values(place, robot, &self.observations, &self.actions, &rewards)
    }
}

/// Refuses what nothing can be learned from: a NaN or an infinity, and an action outside its range. The arrays are row-major.
pub(super) fn check_values(
    place: &str,
    robot: &Robot,
    observations: &[f32],
    actions: &[f32],
    rewards: &[f32],
) -> Result<(), DatasetError> {
    let shape = Shape::of(robot);
    for (array, width, values) in [
        ("observations", shape.observation, observations),
        ("actions", shape.action, actions),
        ("rewards", 1, rewards),
    ] {
        if let Some(index) = values.iter().position(|value| !value.is_finite()) {
            return Err(DatasetError::NotFinite {
                place: place.into(),
                array,
                row: index / width,
                column: index % width,
                value: f64::from(values[index]),
            });
        }
    }
    for (row, values) in actions.chunks_exact(shape.action).enumerate() {
        for (actuator, &value) in robot.action.iter().zip(values) {
            let [low, high] = actuator.range;
            if !(low..=high).contains(&value) {
                return Err(DatasetError::ActionRange {
                    place: place.into(),
                    row,
                    channel: actuator.name.clone(),
                    value,
                    range: actuator.range,
                    robot: Box::new(robot.clone()),
                });
            }
        }
    }
    Ok(())
}
