//! A task of MuJoCo Meta-World as a plant: one simulator process, one task.

use crate::bridge::{BridgeError, Environment, Shape, Step, Worker};
use crate::plant::{Observed, Plant, PlantError, StepOutcome};

/// Simulated time of one step: Meta-World makes 80 of them per second.
pub const CONTROL_PERIOD_US: u32 = 12_500;

/// One Meta-World task, simulated by a worker process that ends with this value.
#[derive(Debug)]
pub struct MetaWorldPlant {
    worker: Worker,
    shape: Shape,
    /// The latest step of the running episode; its buffers are used again.
    latest: Step,
    /// Steps since the last reset, if there was one.
    steps: Option<u32>,
    running: bool,
}

impl MetaWorldPlant {
    /// Starts a simulator and opens the task in it.
    ///
    /// # Errors
    /// When the simulator does not start or has no such task.
    pub fn new(environment: &Environment, task: &str) -> Result<Self, BridgeError> {
        let mut worker = Worker::spawn(environment)?;
        let shape = worker.open(task)?;
        Ok(Self {
            worker,
            shape,
            latest: Step::default(),
            steps: None,
            running: false,
        })
    }

    /// The sizes of the task's observations and actions, and the length of its episodes.
    #[must_use]
    pub const fn shape(&self) -> Shape {
        self.shape
    }
}

impl Plant for MetaWorldPlant {
    fn reset(&mut self, seed: u64) -> Result<(), PlantError> {
        (self.steps, self.running) = (None, false);
        let (observation, _goal) = self.worker.reset(seed).map_err(PlantError::link)?;
        self.latest.observation = observation;
        (self.steps, self.running) = (Some(0), true);
        Ok(())
    }

    fn now_us(&self) -> u64 {
        u64::from(self.steps.unwrap_or(0)) * u64::from(CONTROL_PERIOD_US)
    }

    fn observe(&mut self) -> Result<Observed, PlantError> {
        let sequence = self.steps.ok_or(PlantError::NoEpisode)?;
        Ok(Observed {
            sequence,
            stamp_us: self.now_us(),
            values: self.latest.observation.clone(),
        })
    }

    fn apply(&mut self, action_env: &[f32]) -> Result<StepOutcome, PlantError> {
        let steps = self.steps.filter(|_| self.running);
        let steps = steps.ok_or(PlantError::NoEpisode)?;
        if action_env.len() != self.shape.action {
            return Err(PlantError::ActionLength {
                expected: self.shape.action,
                actual: action_env.len(),
            });
        }
        self.worker
            .step_into(action_env, &mut self.latest)
            .map_err(|error| {
                (self.steps, self.running) = (None, false);
                PlantError::link(error)
            })?;
        let done = self.latest.terminated || self.latest.truncated;
        (self.steps, self.running) = (Some(steps + 1), !done);
        Ok(StepOutcome {
            reward_true: self.latest.reward,
            success: self.latest.success,
            done,
        })
    }
}
