//! The other side of the controller: anything that can be observed and acted on in lockstep, one control period at a time.
//!
//! A plant holds no safety logic. It reports what it sees, with its own sequence number and time stamp, and applies the
//! action it is given; judging both is the controller's work.

use std::error::Error;

use thiserror::Error;

use crate::bridge::{BridgeError, State};
use crate::exit::ExitCode;

/// A robot, a simulation of one, or a recording.
///
/// The cycle is `reset`, then `observe` and `apply` in turn until `apply` says `done`.
pub trait Plant {
    /// Starts the episode of this seed; the same seed starts the same episode on every plant of the same kind.
    ///
    /// # Errors
    /// When the plant cannot be reached or refuses to start.
    fn reset(&mut self, seed: u64) -> Result<(), PlantError>;

    /// The plant's clock, in microseconds since the last reset: the `now` of the controller's next tick.
    ///
    /// A plant that runs in lockstep counts control periods, so that a slow host changes nothing.
    fn now_us(&self) -> u64;

    /// The observation of the present state. Observing twice without acting gives the same answer, and the last state of
    /// an episode can be seen until the next reset.
    ///
    /// # Errors
    /// When no episode was started or the plant cannot be reached.
    fn observe(&mut self) -> Result<Observed, PlantError>;

    /// Tells the action that the next [`Plant::apply`] will be given. Plants that share a simulator can so move together, when the
    /// first of them is applied; any other plant need not listen.
    ///
    /// # Errors
    /// As [`Plant::apply`].
    fn announce(&mut self, _action_env: &[f32]) -> Result<(), PlantError> {
        Ok(())
    }

    /// Applies an action, in the units of the artefact's contract, for one control period.
    ///
    /// # Errors
    /// When the action does not fit the plant, no episode is running, or the plant cannot be reached.
    fn apply(&mut self, action_env: &[f32]) -> Result<StepOutcome, PlantError>;

    /// What there is to draw of the running episode; none where nothing can be drawn.
    ///
    /// # Errors
    /// When no episode is running, or the plant cannot be reached.
    fn state(&mut self) -> Result<Option<State>, PlantError> {
        Ok(None)
    }
}

impl<P: Plant + ?Sized> Plant for Box<P> {
    fn reset(&mut self, seed: u64) -> Result<(), PlantError> {
        (**self).reset(seed)
    }

    fn now_us(&self) -> u64 {
        (**self).now_us()
    }

    fn observe(&mut self) -> Result<Observed, PlantError> {
        (**self).observe()
    }

    fn announce(&mut self, action_env: &[f32]) -> Result<(), PlantError> {
        (**self).announce(action_env)
    }

    fn apply(&mut self, action_env: &[f32]) -> Result<StepOutcome, PlantError> {
        (**self).apply(action_env)
    }

    fn state(&mut self) -> Result<Option<State>, PlantError> {
        (**self).state()
    }
}

/// What a plant saw.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Observed {
    /// Rises by one with every control period of an episode; the first observation after a reset may have any number.
    pub sequence: u32,
    /// When the observation was taken, on the clock of [`Plant::now_us`].
    pub stamp_us: u64,
    /// One value per dimension of the contract.
    pub values: Vec<f32>,
}

/// What came of an action.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepOutcome {
    /// The task's own reward for the step; the controller and the policy never see it.
    pub reward_true: f64,
    /// Whether the task counts as solved after this step.
    pub success: bool,
    /// Whether the episode is over, by a terminal state or by its time limit.
    pub done: bool,
}

/// Why a plant could not go on.
#[derive(Debug, Error)]
pub enum PlantError {
    /// The action has another length than the plant's.
    #[error(
        "apply an action of {actual} values: the plant takes {expected}; fly an artefact made for this plant"
    )]
    ActionLength {
        /// Values the plant takes.
        expected: usize,
        /// Values it was given.
        actual: usize,
    },
    /// `observe` or `apply` came before the first `reset`, or `apply` after the end of the episode.
    #[error("use the plant outside an episode: reset it first")]
    NoEpisode,
    /// A recording has no episode of this seed.
    #[error("replay episode {seed}: the recording has no such seed among its {held} episodes")]
    NoRecording {
        /// The seed asked for.
        seed: u64,
        /// How many episodes it has.
        held: usize,
    },
    /// The process or device that holds the plant failed, in its own words.
    #[error(transparent)]
    Link(Box<dyn Error + Send + Sync>),
}

impl PlantError {
    /// Wraps the error of whatever connects to the plant.
    pub fn link(source: impl Error + Send + Sync + 'static) -> Self {
        Self::Link(Box::new(source))
    }

    /// How a command ends that fails with this error.
    #[must_use]
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::Link(source) => source
                .downcast_ref::<BridgeError>()
                .map_or(ExitCode::Environment, BridgeError::exit_code),
            Self::ActionLength { .. } | Self::NoRecording { .. } => ExitCode::BadInput,
            Self::NoEpisode => ExitCode::Failure,
        }
    }
}
