//! The control loop: one observation in, one action out, every control period, whatever happens.
//!
//! A controller exists only for an artefact that passed its load gate. Once a check fails, the reason is latched and
//! the safe action goes out until someone decides otherwise.

mod bare;
mod guard;

pub use bare::BareController;
pub use guard::Guard;

use serde::{Deserialize, Serialize};
use ted_policy::{Artifact, ArtifactError};

use crate::proven::Proven;
use crate::safety::{Action, Fault, ObservationFrame};
use crate::workspace::Workspace;

/// In which numbers a controller computes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(feature = "std", derive(clap::ValueEnum))]
pub enum Numeric {
    /// Single precision, as trained.
    #[default]
    F32,
    /// The quantised networks: 8-bit weights, 16-bit activations.
    #[cfg_attr(feature = "std", value(alias = "int"))]
    Integer,
}

/// What a tick did.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Status {
    /// Ticks since the start of the episode, this one not counted.
    pub tick: u32,
    /// The latched fault: while there is one, the safe action goes out.
    pub fault: Option<Fault>,
    /// Whether the policy's action was outside the contract's range.
    pub clamped: bool,
    /// Whether the policy's action was too far from the last one sent.
    pub slew_limited: bool,
    /// Whether this tick came late.
    pub deadline_missed: bool,
    /// Late ticks since the start of the episode.
    pub deadlines_missed: u32,
}

/// A policy behind its checks, ready to fly, with the memory it computes in.
#[derive(Clone, Debug)]
pub struct Controller<'a> {
    bare: BareController<'a>,
    workspace: Workspace,
}

impl<'a> Controller<'a> {
    /// The load gate. What parsing proved holds already: shapes, finite weights, ordered ranges, a way to stop, at least
    /// one golden vector. Here this machine must compute the golden vectors bit for bit.
    ///
    /// # Errors
    /// The golden vector it failed on; the artefact does not fly then.
    pub fn load(artifact: &Artifact<'a>, numeric: Numeric) -> Result<Self, ArtifactError> {
        let proven = Proven::of(artifact, numeric)?;
        Ok(Self {
            bare: BareController::load(artifact, proven)?,
            workspace: Workspace::new(numeric),
        })
    }

    /// One control period: judges the observation, asks the policy, judges the action.
    ///
    /// There is always an action. With a fault latched it is the safe one, and the policy is not asked.
    pub fn tick(&mut self, now_us: u64, frame: &ObservationFrame<'_>) -> (Action, Status) {
        self.bare.tick(now_us, frame, &mut self.workspace)
    }

    /// What goes out when no observation came within `limit_us`: the safe action, with [`Fault::LinkSilent`] latched unless
    /// another fault was before.
    pub fn tick_without_observation(&mut self, limit_us: u32) -> (Action, Status) {
        self.bare.tick_without_observation(limit_us)
    }

    /// Starts a new episode: the plant is at rest, and everything of the last episode is forgotten.
    pub fn reset(&mut self) {
        self.bare.reset();
    }

    /// Gives the controls back to the policy in mid-episode: forgets the latched fault and accepts any sequence number
    /// and any pause once, but still knows what was last sent, so that a held gripper stays held.
    pub fn rearm(&mut self) {
        self.bare.rearm();
    }
}
