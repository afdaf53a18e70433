//! A task of a simulator process as a plant: several episodes of one task side by side.

use std::cell::RefCell;
use std::rc::Rc;

use crate::bridge::{BridgeError, Environment, Move, Shape, State, Step, Worker};
use crate::plant::{Observed, Plant, PlantError, StepOutcome};

/// One task, simulated by a worker process that ends with the last of the plants made with this one.
#[derive(Debug)]
pub struct SimulatedPlant {
    shared: Rc<RefCell<Shared>>,
    slot: u16,
    shape: Shape,
    /// Simulated time of one step.
    period_us: u32,
    /// The latest step of the running episode.
    latest: Step,
    /// Steps since the last reset, if there was one.
    steps: Option<u32>,
    running: bool,
}

impl SimulatedPlant {
    /// Starts a simulator and opens the task in it, whose steps take `period_us` of simulated time.
    ///
    /// # Errors
    /// When the simulator does not start or has no such task.
    pub fn new(environment: &Environment, task: &str, period_us: u32) -> Result<Self, BridgeError> {
        let (shared, shape) = Shared::open(environment, task, period_us)?;
        Ok(Self::in_slot(&shared, shape, period_us, 0))
    }

    /// Several plants in one simulator. Steps that are announced are made together, which saves most of the way there and back.
    ///
    /// # Errors
    /// When the simulator does not start or has no such task.
    pub fn several(
        environment: &Environment,
        task: &str,
        period_us: u32,
        plants: u16,
    ) -> Result<Vec<Self>, BridgeError> {
        let (shared, shape) = Shared::open(environment, task, period_us)?;
        Ok((0..plants)
            .map(|slot| Self::in_slot(&shared, shape, period_us, slot))
            .collect())
    }

    fn in_slot(shared: &Rc<RefCell<Shared>>, shape: Shape, period_us: u32, slot: u16) -> Self {
        Self {
            shared: Rc::clone(shared),
            slot,
            shape,
            period_us,
            latest: Step::default(),
            steps: None,
            running: false,
        }
    }

    /// The sizes of the task's observations and actions, and the length of its episodes.
    #[must_use]
    pub const fn shape(&self) -> Shape {
        self.shape
    }

    /// Steps made so far, if this action can be the next one.
    fn ready_for(&self, action_env: &[f32]) -> Result<u32, PlantError> {
        let steps = self.steps.filter(|_| self.running);
        let steps = steps.ok_or(PlantError::NoEpisode)?;
        if action_env.len() == self.shape.action {
            Ok(steps)
        } else {
            Err(PlantError::ActionLength {
                expected: self.shape.action,
                actual: action_env.len(),
            })
        }
    }
}

impl Plant for SimulatedPlant {
    fn reset(&mut self, seed: u64) -> Result<(), PlantError> {
        (self.steps, self.running) = (None, false);
        let reset = self.shared.borrow_mut().reset(self.slot, seed);
        self.latest.observation = reset.map_err(PlantError::link)?;
        (self.steps, self.running) = (Some(0), true);
        Ok(())
    }

    fn now_us(&self) -> u64 {
        u64::from(self.steps.unwrap_or(0)) * u64::from(self.period_us)
    }

    fn observe(&mut self) -> Result<Observed, PlantError> {
        let sequence = self.steps.ok_or(PlantError::NoEpisode)?;
        Ok(Observed {
            sequence,
            stamp_us: self.now_us(),
            values: self.latest.observation.clone(),
        })
    }

    fn announce(&mut self, action_env: &[f32]) -> Result<(), PlantError> {
        self.ready_for(action_env)?;
        self.shared.borrow_mut().announce(self.slot, action_env);
        Ok(())
    }

    fn apply(&mut self, action_env: &[f32]) -> Result<StepOutcome, PlantError> {
        let steps = self.ready_for(action_env)?;
        let stepped = self.shared.borrow_mut().step(self.slot, action_env);
        self.latest = stepped.map_err(|error| {
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

    fn state(&mut self) -> Result<Option<State>, PlantError> {
        if self.shape.qpos == 0 {
            return Ok(None);
        }
        let state = self.shared.borrow_mut().worker.state(self.slot);
        state.map(Some).map_err(PlantError::link)
    }
}

/// What plants in one simulator have in common.
#[derive(Debug)]
struct Shared {
    worker: Worker,
    /// Actions to be applied with the next one, at most one for a slot.
    announced: Vec<Move>,
    /// What came of actions that were applied with another plant's, by slot.
    made: Vec<(u16, Step)>,
}

impl Shared {
    fn open(
        environment: &Environment,
        task: &str,
        period_us: u32,
    ) -> Result<(Rc<RefCell<Self>>, Shape), BridgeError> {
        let mut worker = Worker::spawn(environment)?;
        match said_period_us(worker.versions()) {
            Some(world) if world != period_us => {
                let policy = period_us;
                return Err(BridgeError::OtherPeriod { world, policy });
            }
            _ => {}
        }
        let shape = worker.open(task)?;
        let shared = Self {
            worker,
            announced: Vec::new(),
            made: Vec::new(),
        };
        Ok((Rc::new(RefCell::new(shared)), shape))
    }

    fn reset(&mut self, slot: u16, seed: u64) -> Result<Vec<f32>, BridgeError> {
        self.announced.retain(|one| one.slot != slot);
        self.made.retain(|(made, _)| *made != slot);
        let (observation, _goal) = self.worker.reset(slot, seed)?;
        Ok(observation)
    }

    fn announce(&mut self, slot: u16, action_env: &[f32]) {
        self.announced.retain(|one| one.slot != slot);
        let action = action_env.to_vec();
        self.announced.push(Move { slot, action });
    }

    fn step(&mut self, slot: u16, action_env: &[f32]) -> Result<Step, BridgeError> {
        if let Some(own) = self.made.iter().position(|(made, _)| *made == slot) {
            return Ok(self.made.swap_remove(own).1);
        }
        // The one asked for goes first; the announcement that it comes is not needed any more.
        let action = action_env.to_vec();
        let mut moves = vec![Move { slot, action }];
        moves.extend(self.announced.drain(..).filter(|one| one.slot != slot));
        let mut steps = self.worker.step_all(&moves)?;
        let own = steps.remove(0);
        let others = moves[1..].iter().map(|one| one.slot);
        self.made.extend(others.zip(steps));
        Ok(own)
    }
}

/// How long a worker says that its steps take, if it says so.
fn said_period_us(versions: &str) -> Option<u32> {
    let mut parts = versions.split_whitespace();
    parts
        .find_map(|part| part.strip_prefix("period_us="))?
        .parse()
        .ok()
}
