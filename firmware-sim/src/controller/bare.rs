//! The control loop itself, in memory that it is lent.

use ted_core::Policy;
use ted_core::quantised::QuantisedPolicy;
use ted_policy::{Artifact, ArtifactError};

use super::{Guard, Numeric, Status};
use crate::proven::Proven;
use crate::safety::{Action, Fault, ObservationFrame};
use crate::workspace::Workspace;

/// A controller without working memory of its own: a device lends it to whoever computes.
///
/// It copies the contract's numbers, so that a tick touches nothing but itself, the memory it is lent and the borrowed
/// weights.
#[derive(Clone, Debug)]
pub struct BareController<'a> {
    policy: NumericPolicy<'a>,
    guard: Guard,
}

impl<'a> BareController<'a> {
    /// A controller for an artefact whose golden vectors this machine computes; `proven` must be of this artefact.
    ///
    /// # Errors
    /// When the artefact has no networks in those numbers, which the proof rules out.
    // Not part of its caller, whose stack would hold everything twice.
    #[inline(never)]
    pub fn load(artifact: &Artifact<'a>, proven: Proven) -> Result<Self, ArtifactError> {
        Ok(Self {
            policy: NumericPolicy::load(artifact, proven.numeric())?,
            guard: Guard::new(artifact.terms()),
        })
    }

    /// One control period: judges the observation, asks the policy, judges the action.
    ///
    /// There is always an action. With a fault latched it is the safe one, and the policy is not asked.
    pub fn tick(
        &mut self,
        now_us: u64,
        frame: &ObservationFrame<'_>,
        workspace: &mut Workspace,
    ) -> (Action, Status) {
        let policy = &self.policy;
        self.guard.tick(now_us, frame, |obs_raw, action_unit| {
            policy.act(obs_raw, workspace, action_unit)
        })
    }

    /// What goes out when no observation came within `limit_us`: the safe action, with [`Fault::LinkSilent`] latched unless
    /// another fault was before.
    pub fn tick_without_observation(&mut self, limit_us: u32) -> (Action, Status) {
        self.guard.tick_without_observation(limit_us)
    }

    /// What the robot's numbers are to the policy, in [-1, 1]; numbers without a channel stay.
    #[must_use]
    pub fn unit(&self, action_env: &[f32]) -> Action {
        self.guard.unit(action_env)
    }

    /// Starts a new episode: the plant is at rest, and everything of the last episode is forgotten.
    pub fn reset(&mut self) {
        self.guard.reset();
    }

    /// Gives the controls back to the policy in mid-episode: forgets the latched fault and accepts any sequence number
    /// and any pause once, but still knows what was last sent, so that a held gripper stays held.
    pub fn rearm(&mut self) {
        self.guard.rearm();
    }
}

/// The policy in the numbers it is flown in.
#[derive(Clone, Debug)]
enum NumericPolicy<'a> {
    F32(Policy<'a>),
    Integer(QuantisedPolicy<'a>),
}

impl<'a> NumericPolicy<'a> {
    #[inline(never)]
    fn load(artifact: &Artifact<'a>, numeric: Numeric) -> Result<Self, ArtifactError> {
        match numeric {
            Numeric::F32 => Ok(Self::F32(artifact.policy())),
            Numeric::Integer => match artifact.integer_policy() {
                Some(policy) => Ok(Self::Integer(policy)),
                None => Err(ArtifactError::NoIntegers),
            },
        }
    }

    /// Refuses a workspace for other numbers.
    fn act(
        &self,
        obs_raw: &[f32],
        workspace: &mut Workspace,
        action_unit: &mut [f32],
    ) -> Result<(), Fault> {
        let acted = match (self, workspace) {
            (Self::F32(policy), Workspace::F32(scratch)) => {
                policy.act(obs_raw, scratch, action_unit)
            }
            (Self::Integer(policy), Workspace::Integer(scratch)) => {
                policy.act(obs_raw, scratch, action_unit)
            }
            _ => return Err(Fault::PolicyRefused),
        };
        acted.map_err(|_| Fault::PolicyRefused)
    }
}
