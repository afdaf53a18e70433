//! A recording as a plant: it shows the recorded observations, whatever it is told to do, and measures how far the
//! actions sent to it are from the recorded ones.
//!
//! A policy that was recorded through this controller comes back with a difference of zero.

use std::collections::HashSet;

use serde::Serialize;
use thiserror::Error;

use super::recording::{Recording, RecordingError, RecordingShape};
use crate::plant::{Observed, Plant, PlantError, StepOutcome};

/// Where a sent action was farthest from the recorded one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// The episode.
    pub seed: u64,
    /// The step.
    pub step: usize,
    /// The action dimension.
    pub dimension: usize,
    /// What the controller sent.
    pub sent: f32,
    /// What was recorded.
    pub recorded: f32,
    /// The distance between the two; infinite when one of them is NaN.
    pub absolute: f32,
}

/// Recorded episodes that cannot be shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum ReplayError {
    /// There is none.
    #[error("replay a recording: it holds no episode")]
    Empty,
    /// Two have the same seed, and only the first could be asked for.
    #[error("replay episode {seed}: two recorded episodes have this seed")]
    SameSeed {
        /// The seed.
        seed: u64,
    },
    /// The arrays of one do not fit together.
    #[error(transparent)]
    Arrays(#[from] RecordingError),
}

/// Recorded episodes, shown again.
#[derive(Clone, Debug)]
pub struct ReplayPlant {
    shape: RecordingShape,
    recordings: Vec<Recording>,
    running: Option<(usize, usize)>,
    largest: Option<Difference>,
}

impl ReplayPlant {
    /// A plant that shows these episodes.
    ///
    /// # Errors
    /// When there is none, two have the same seed, or a recording's arrays do not have the lengths that its number of
    /// rewards asks for.
    pub fn new(shape: RecordingShape, recordings: Vec<Recording>) -> Result<Self, ReplayError> {
        if recordings.is_empty() {
            return Err(ReplayError::Empty);
        }
        let mut seeds = HashSet::new();
        for recording in &recordings {
            recording.check(shape)?;
            let seed = recording.seed;
            if !seeds.insert(seed) {
                return Err(ReplayError::SameSeed { seed });
            }
        }
        Ok(Self {
            shape,
            recordings,
            running: None,
            largest: None,
        })
    }

    /// The seeds of the recorded episodes, in their order.
    pub fn seeds(&self) -> impl Iterator<Item = u64> + '_ {
        self.recordings.iter().map(|recording| recording.seed)
    }

    /// The largest difference since this plant was made; none before the first action.
    #[must_use]
    pub fn largest_difference(&self) -> Option<Difference> {
        self.largest
    }

    fn episode(&self) -> Result<(&Recording, usize), PlantError> {
        let (index, step) = self.running.ok_or(PlantError::NoEpisode)?;
        let recording = self.recordings.get(index).ok_or(PlantError::NoEpisode)?;
        Ok((recording, step))
    }
}

impl Plant for ReplayPlant {
    fn reset(&mut self, seed: u64) -> Result<(), PlantError> {
        let index = self.seeds().position(|recorded| recorded == seed);
        let index = index.ok_or(PlantError::NoRecording {
            seed,
            held: self.recordings.len(),
        })?;
        self.running = Some((index, 0));
        Ok(())
    }

    fn now_us(&self) -> u64 {
        let step = self.running.map_or(0, |(_, step)| step);
        step as u64 * u64::from(self.shape.control_period_us)
    }

    fn observe(&mut self) -> Result<Observed, PlantError> {
        let (recording, step) = self.episode()?;
        Ok(Observed {
            sequence: step as u32,
            stamp_us: self.now_us(),
            values: recording.observation(self.shape, step).to_vec(),
        })
    }

    fn apply(&mut self, action_env: &[f32]) -> Result<StepOutcome, PlantError> {
        let expected = self.shape.action_dim;
        if action_env.len() != expected {
            return Err(PlantError::ActionLength {
                expected,
                actual: action_env.len(),
            });
        }
        let (recording, step) = self.episode()?;
        let (Some(&reward_true), Some(&success)) =
            (recording.rewards.get(step), recording.success.get(step))
        else {
            return Err(PlantError::NoEpisode);
        };
        let done = step + 1 == recording.rewards.len();
        let recorded = recording.action(self.shape, step);
        let worst = farthest(recording.seed, step, action_env, recorded);
        if self
            .largest
            .is_none_or(|largest| worst.is_some_and(|worst| worst.absolute > largest.absolute))
        {
            self.largest = worst;
        }
        self.running = self.running.map(|(index, step)| (index, step + 1));
        Ok(StepOutcome {
            reward_true,
            success,
            done,
        })
    }
}

fn farthest(seed: u64, step: usize, sent: &[f32], recorded: &[f32]) -> Option<Difference> {
    let pairs = sent.iter().zip(recorded).enumerate();
    let differences = pairs.map(|(dimension, (&sent, &recorded))| {
        let distance = (sent - recorded).abs();
        let absolute = if distance.is_nan() {
            f32::INFINITY
        } else {
            distance
        };
        Difference {
            seed,
            step,
            dimension,
            sent,
            recorded,
            absolute,
        }
    });
    differences.reduce(|worst, next| {
        if next.absolute > worst.absolute {
            next
        } else {
            worst
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHAPE: RecordingShape = RecordingShape {
        observation_dim: 2,
        action_dim: 1,
        control_period_us: 1_000,
    };

    fn recording() -> Recording {
        Recording {
            seed: 9,
            observations: vec![0.0, 0.1, 1.0, 1.1, 2.0, 2.1],
            actions: vec![0.5, -0.5],
            rewards: vec![1.0, 2.0],
            success: vec![false, true],
        }
    }

    #[test]
    fn a_recording_is_shown_as_it_was_whatever_is_sent() {
        let mut plant = ReplayPlant::new(SHAPE, vec![recording()]).unwrap();
        plant.reset(9).unwrap();
        assert_eq!(plant.observe().unwrap().values, [0.0, 0.1]);
        assert_eq!(plant.apply(&[1.0]).unwrap().reward_true, 1.0);
        let second = plant.observe().unwrap();
        assert_eq!((second.sequence, second.stamp_us), (1, 1_000));
        assert_eq!(second.values, [1.0, 1.1]);
        let last = plant.apply(&[-0.5]).unwrap();
        assert!(last.done && last.success);
        assert!(matches!(plant.apply(&[0.0]), Err(PlantError::NoEpisode)));
    }

    #[test]
    fn the_largest_difference_is_kept_with_its_place() {
        let mut plant = ReplayPlant::new(SHAPE, vec![recording()]).unwrap();
        plant.reset(9).unwrap();
        plant.apply(&[0.5]).unwrap();
        assert_eq!(plant.largest_difference().unwrap().absolute, 0.0);
        plant.apply(&[0.25]).unwrap();
        let worst = plant.largest_difference().unwrap();
        assert_eq!((worst.step, worst.absolute), (1, 0.75));
        plant.reset(9).unwrap();
        plant.apply(&[f32::NAN]).unwrap();
        assert_eq!(plant.largest_difference().unwrap().absolute, f32::INFINITY);
    }

    #[test]
    fn no_episode_or_two_of_one_seed_are_refused() {
        let refused = |recordings| ReplayPlant::new(SHAPE, recordings).map(|_| ()).unwrap_err();
        assert_eq!(refused(vec![]), ReplayError::Empty);
        assert_eq!(
            refused(vec![recording(), recording()]),
            ReplayError::SameSeed { seed: 9 }
        );
    }

    #[test]
    fn an_unknown_seed_is_refused_with_the_known_ones() {
        let mut plant = ReplayPlant::new(SHAPE, vec![recording()]).unwrap();
        let error = plant.reset(1).unwrap_err();
        assert_eq!(
            error.to_string(),
            "replay episode 1: the recording has no such seed among its 1 episodes"
        );
    }
}
