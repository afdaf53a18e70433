//! Recorded episodes: what was seen, what was sent, what came of it. On disk they are one JSON object.

use std::fs::File;
use std::io::{self, BufReader};
use std::path::Path;

use serde::{Deserialize, Serialize};
use ted_policy::Contract;
use thiserror::Error;

use crate::disk::{self, WriteError};

/// One recorded episode.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recording {
    /// The seed the episode is asked for by.
    pub seed: u64,
    /// One row per step and one after the last.
    pub observations: Vec<f32>,
    /// One row per step.
    pub actions: Vec<f32>,
    /// One value per step.
    pub rewards: Vec<f64>,
    /// One value per step.
    pub success: Vec<bool>,
}

/// The row lengths and the period that all recordings of a plant share.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordingShape {
    /// Values in an observation.
    pub observation_dim: usize,
    /// Values in an action.
    pub action_dim: usize,
    /// Time between two steps.
    pub control_period_us: u32,
}

/// The arrays of a recording do not fit together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("read episode {seed}: its {array} hold {actual} values, {expected} are needed")]
pub struct RecordingError {
    /// The episode.
    pub seed: u64,
    /// Which array.
    pub array: &'static str,
    /// Values it must hold.
    pub expected: usize,
    /// Values it holds.
    pub actual: usize,
}

/// Recorded episodes with their shape: the content of a recording file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recordings {
    /// What all of them share.
    pub shape: RecordingShape,
    /// The episodes.
    pub episodes: Vec<Recording>,
}

impl Recordings {
    /// Reads a recording file. Whoever uses its arrays checks them first, with [`Recording::check`].
    ///
    /// # Errors
    /// When the file cannot be read or is no recording.
    pub fn read(path: &Path) -> io::Result<Self> {
        Ok(serde_json::from_reader(BufReader::new(File::open(path)?))?)
    }

    /// Writes a recording file; every finite number comes back with its bits.
    ///
    /// # Errors
    /// When the file cannot be written, or a number is not finite, for which JSON has no word.
    pub fn write(&self, path: &Path) -> Result<(), WriteError> {
        if let Some(episode) = self.episodes.iter().find(|episode| !episode.is_finite()) {
            let seed = episode.seed;
            let message = format!("the recording of seed {seed} holds a number that is not finite");
            return Err(WriteError::at(path, io::Error::other(message)));
        }
        let text = serde_json::to_vec(self)
            .map_err(|error| WriteError::at(path, io::Error::other(error)))?;
        disk::replace(path, &text)
    }
}

impl RecordingShape {
    /// The shape of what is recorded from a robot with this contract.
    #[must_use]
    pub fn of(contract: &Contract<'_>) -> Self {
        Self {
            observation_dim: contract.observation.len(),
            action_dim: contract.action.len(),
            control_period_us: contract.control_period_us,
        }
    }
}

impl Recording {
    /// What was seen before this step; empty behind the end.
    #[must_use]
    pub fn observation(&self, shape: RecordingShape, step: usize) -> &[f32] {
        row(&self.observations, step, shape.observation_dim)
    }

    /// What was sent at this step; empty behind the end.
    #[must_use]
    pub fn action(&self, shape: RecordingShape, step: usize) -> &[f32] {
        row(&self.actions, step, shape.action_dim)
    }

    fn is_finite(&self) -> bool {
        let mut values = self.observations.iter().chain(&self.actions);
        values.all(|value| value.is_finite()) && self.rewards.iter().all(|value| value.is_finite())
    }

    /// Whether the arrays have the lengths that the number of rewards asks for.
    ///
    /// # Errors
    /// The first array that has not.
    pub fn check(&self, shape: RecordingShape) -> Result<(), RecordingError> {
        let steps = self.rewards.len();
        let needed = [
            ("rewards", steps.max(1), steps),
            (
                "observations",
                (steps + 1).saturating_mul(shape.observation_dim),
                self.observations.len(),
            ),
            (
                "actions",
                steps.saturating_mul(shape.action_dim),
                self.actions.len(),
            ),
            ("success flags", steps, self.success.len()),
        ];
        match needed
            .into_iter()
            .find(|(_, expected, actual)| expected != actual)
        {
            Some((array, expected, actual)) => Err(RecordingError {
                seed: self.seed,
                array,
                expected,
                actual,
            }),
            None => Ok(()),
        }
    }
}

fn row(array: &[f32], index: usize, dim: usize) -> &[f32] {
    array
        .get(index * dim..(index + 1) * dim)
        .unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::splitmix::mix;

    const SHAPE: RecordingShape = RecordingShape {
        observation_dim: 2,
        action_dim: 1,
        control_period_us: 1_000,
    };

    fn recording() -> Recording {
        Recording {
            seed: u64::MAX,
            observations: vec![0.0, 0.1, 1.0, 1.1, 2.0, 2.1],
            actions: vec![0.5, -0.5],
            rewards: vec![1.0, 2.0],
            success: vec![false, true],
        }
    }

    #[test]
    fn an_array_of_the_wrong_length_is_named() {
        assert_eq!(recording().check(SHAPE), Ok(()));
        let mut short = recording();
        short.observations.pop();
        let error = short.check(SHAPE).unwrap_err();
        assert_eq!(
            (error.array, error.expected, error.actual),
            ("observations", 6, 5)
        );
        let huge = RecordingShape {
            observation_dim: 1 << 63,
            ..SHAPE
        };
        assert!(recording().check(huge).is_err());
        assert_eq!(
            Recording::default().check(SHAPE).unwrap_err().array,
            "rewards"
        );
    }

    #[test]
    fn numbers_come_back_from_a_file_with_their_bits() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("recording.json");
        let mut numbers = recording();
        let drawn = (0..20_000).map(|index| f32::from_bits(mix(1, index) as u32));
        numbers.actions = drawn.filter(|value| value.is_finite()).collect();
        let drawn = (0..20_000).map(|index| f64::from_bits(mix(2, index)));
        numbers.rewards = drawn.filter(|value| value.is_finite()).collect();
        let mut written = Recordings {
            shape: SHAPE,
            episodes: vec![numbers],
        };
        written.write(&path).unwrap();
        assert_eq!(Recordings::read(&path).unwrap(), written);

        written.episodes[0].rewards[7] = f64::NAN;
        let error = written.write(&path).unwrap_err().to_string();
        assert!(error.contains("not finite"), "{error}");
    }
}
