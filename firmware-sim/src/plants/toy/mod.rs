//! A plant that needs no Python: a point on a table, a goal, and a gripper that must be closed there.
//!
//! | observation | range | | action | range | effect |
//! |---|---|---|---|---|---|
//! | `x`, `y` | [-1, 1] | | `move_x`, `move_y` | [-1, 1] | moves by a twentieth of it |
//! | `goal_x`, `goal_y` | [-1, 1] | | `gripper` | [-1, 1] | opens or closes to it at once |
//! | `gripper` | [-1, 1] | | | | |
//!
//! In other [`Units`] the ranges of the observation are others.

mod policy;
mod units;

pub use policy::{ToyError, artifact_bytes, artifact_spec};
pub use units::Units;

use crate::plant::{Observed, Plant, PlantError, StepOutcome};
use crate::splitmix::{fraction, mix};

/// Values in an observation.
pub const OBSERVATION_DIM: usize = 5;
/// Values in an action.
pub const ACTION_DIM: usize = 3;
/// The control period: 100 Hz.
pub const CONTROL_PERIOD_US: u32 = 10_000;
/// Steps in an episode.
pub const EPISODE_STEPS: u32 = 100;

const TABLE: u64 = 0x746f_7920_7461_626c;
const REACH_PER_STEP: f32 = 0.05;
const NEAR: f32 = 0.05;
const CLOSED: f32 = 0.5;

/// The toy. Its episodes are functions of the seed and the actions.
#[derive(Clone, Debug, Default)]
pub struct ToyPlant {
    units: Units,
    episode: Option<Episode>,
}

#[derive(Clone, Debug)]
struct Episode {
    step: u32,
    point: [f32; 2],
    goal: [f32; 2],
    gripper: f32,
}

impl ToyPlant {
    /// A toy before its first reset.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// A toy that reports in other units.
    #[must_use]
    pub fn in_units(units: Units) -> Self {
        Self {
            units,
            episode: None,
        }
    }
}

impl Plant for ToyPlant {
    fn reset(&mut self, seed: u64) -> Result<(), PlantError> {
        let place = |index| 1.8 * fraction(mix(seed ^ TABLE, index)) - 0.9;
        let (point, goal) = ([place(0), place(1)], [place(2), place(3)]);
        self.episode = Some(Episode {
            step: 0,
            point,
            goal,
            gripper: 0.0,
        });
        Ok(())
    }

    fn now_us(&self) -> u64 {
        let step = self.episode.as_ref().map_or(0, |episode| episode.step);
        u64::from(step) * u64::from(CONTROL_PERIOD_US)
    }

    fn observe(&mut self) -> Result<Observed, PlantError> {
        let stamp_us = self.now_us();
        let episode = self.episode.as_ref().ok_or(PlantError::NoEpisode)?;
        let ([x, y], [goal_x, goal_y]) = (episode.point, episode.goal);
        let plain = [x, y, goal_x, goal_y, episode.gripper];
        let scaled = plain.iter().zip(self.units.scale());
        let values = scaled.map(|(value, scale)| value * scale).collect();
        Ok(Observed {
            sequence: episode.step,
            stamp_us,
            values,
        })
    }

    fn apply(&mut self, action_env: &[f32]) -> Result<StepOutcome, PlantError> {
        let &[move_x, move_y, gripper] = action_env else {
            return Err(PlantError::ActionLength {
                expected: ACTION_DIM,
                actual: action_env.len(),
            });
        };
        let running = self
            .episode
            .as_mut()
            .filter(|episode| episode.step < EPISODE_STEPS);
        running
            .ok_or(PlantError::NoEpisode)
            .map(|episode| episode.step([move_x, move_y], gripper))
    }
}

impl Episode {
    fn step(&mut self, moves: [f32; 2], gripper: f32) -> StepOutcome {
        for (place, wanted) in self.point.iter_mut().zip(moves) {
            *place = (*place + REACH_PER_STEP * wanted.clamp(-1.0, 1.0)).clamp(-1.0, 1.0);
        }
        self.gripper = gripper.clamp(-1.0, 1.0);
        self.step += 1;
        let [far_x, far_y] = [self.goal[0] - self.point[0], self.goal[1] - self.point[1]];
        let distance = (far_x * far_x + far_y * far_y).sqrt();
        StepOutcome {
            reward_true: 1.0 / (1.0 + 10.0 * f64::from(distance)),
            success: distance < NEAR && self.gripper > CLOSED,
            done: self.step == EPISODE_STEPS,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_episode_is_a_function_of_its_seed() {
        let mut plant = ToyPlant::new();
        let mut first = |seed| {
            plant.reset(seed).unwrap();
            plant.observe().unwrap()
        };
        assert_eq!(first(1), first(1));
        assert_ne!(first(1).values, first(2).values);
    }

    #[test]
    fn an_episode_ends_at_its_time_limit_and_not_before() {
        let mut plant = ToyPlant::new();
        assert!(matches!(plant.apply(&[0.0; 3]), Err(PlantError::NoEpisode)));
        plant.reset(0).unwrap();
        for step in 1..=EPISODE_STEPS {
            assert_eq!(plant.apply(&[0.0; 3]).unwrap().done, step == EPISODE_STEPS);
        }
        assert!(matches!(plant.apply(&[0.0; 3]), Err(PlantError::NoEpisode)));
    }

    #[test]
    fn other_units_change_what_is_seen_and_nothing_else() {
        let mut plants = Units::ALL.map(ToyPlant::in_units);
        let [table, micrometres] = plants.each_mut().map(|plant| {
            plant.reset(3).unwrap();
            let outcome = plant.apply(&[0.5, -0.5, 0.75]).unwrap();
            (outcome, plant.observe().unwrap().values)
        });
        assert_eq!(table.0, micrometres.0);
        assert_eq!((table.1[4], micrometres.1[4]), (0.75, 75.0));
        assert_eq!(table.1[0] * 500_000.0, micrometres.1[0]);
        assert_eq!(Units::of_task("toy-micrometres"), Some(Units::Micrometres));
        assert_eq!(Units::of_task("toy-reach"), None);
    }

    #[test]
    fn an_action_of_another_length_is_refused() {
        let mut plant = ToyPlant::new();
        plant.reset(0).unwrap();
        let error = plant.apply(&[0.0; 4]).unwrap_err();
        assert!(matches!(
            error,
            PlantError::ActionLength {
                expected: 3,
                actual: 4
            }
        ));
    }
}
