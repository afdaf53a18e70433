//! A plant that writes down everything that passes between another plant and the controller.

use std::mem;
use std::sync::{Arc, Mutex, PoisonError};

use super::recording::Recording;
use crate::plant::{Observed, Plant, PlantError, StepOutcome};

/// Where finished recordings go; the recorders of all workers share one.
#[derive(Clone, Debug, Default)]
pub struct Shelf(Arc<Mutex<Vec<Recording>>>);

impl Shelf {
    /// Takes the recordings that were finished so far, in the order they were finished.
    #[must_use]
    pub fn take(&self) -> Vec<Recording> {
        mem::take(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn add(&self, recording: Recording) {
        self.0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push(recording);
    }
}

/// A plant and the recording of its running episode.
#[derive(Clone, Debug)]
pub struct Recorder<P> {
    plant: P,
    shelf: Shelf,
    running: Recording,
}

impl<P: Plant> Recorder<P> {
    /// Records the episodes of `plant`; an episode that does not end leaves no recording.
    pub fn new(plant: P, shelf: Shelf) -> Self {
        Self {
            plant,
            shelf,
            running: Recording::default(),
        }
    }
}

impl<P: Plant> Plant for Recorder<P> {
    fn reset(&mut self, seed: u64) -> Result<(), PlantError> {
        self.running = Recording {
            seed,
            ..Recording::default()
        };
        self.plant.reset(seed)
    }

    fn now_us(&self) -> u64 {
        self.plant.now_us()
    }

    fn observe(&mut self) -> Result<Observed, PlantError> {
        self.plant.observe()
    }

    fn announce(&mut self, action_env: &[f32]) -> Result<(), PlantError> {
        self.plant.announce(action_env)
    }

    fn apply(&mut self, action_env: &[f32]) -> Result<StepOutcome, PlantError> {
        // Observing twice shows the same, so the recording does not depend on how often the controller looked.
        self.running
            .observations
            .extend(self.plant.observe()?.values);
        let outcome = self.plant.apply(action_env)?;
        self.running.actions.extend(action_env);
        self.running.rewards.push(outcome.reward_true);
        self.running.success.push(outcome.success);
        if outcome.done {
            self.running
                .observations
                .extend(self.plant.observe()?.values);
            self.shelf.add(mem::take(&mut self.running));
        }
        Ok(outcome)
    }
}
