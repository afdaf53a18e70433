//! The control loop itself, in memory that it is lent.

use ted_core::Policy;
use ted_core::quantised::QuantisedPolicy;
use ted_policy::{Artifact, ArtifactError};

use super::{Numeric, Status};
use crate::proven::Proven;
use crate::safety::{
    Action, ActionGuard, Deadline, Fault, ObservationFrame, ObservationGuard, Sent,
};
use crate::workspace::Workspace;

/// A controller without working memory of its own: a device lends it to whoever computes.
///
/// It copies the contract's numbers, so that a tick touches nothing but itself, the memory it is lent and the borrowed
/// weights.
#[derive(Clone, Debug)]
pub struct BareController<'a> {
    policy: NumericPolicy<'a>,
    observation_guard: ObservationGuard,
    action_guard: ActionGuard,
    deadline: Deadline,
    latched: Option<Fault>,
    tick: u32,
}

impl<'a> BareController<'a> {
    /// A controller for an artefact whose golden vectors this machine computes; `proven` must be of this artefact.
    ///
    /// # Errors
    /// When the artefact has no networks in those numbers, which the proof rules out.
    // Not part of its caller, whose stack would hold everything twice.
    #[inline(never)]
    pub fn load(artifact: &Artifact<'a>, proven: Proven) -> Result<Self, ArtifactError> {
        let terms = artifact.terms();
        Ok(Self {
            policy: NumericPolicy::load(artifact, proven.numeric())?,
            observation_guard: ObservationGuard::new(terms),
            action_guard: ActionGuard::new(terms),
            deadline: Deadline::new(terms.control_period_us),
            latched: None,
            tick: 0,
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
        let missed_before = self.deadline.missed();
        let on_time = self.deadline.tick(now_us);
        let sent = match self.latched {
            Some(fault) => Err(fault),
            None => on_time.and_then(|()| self.fly(now_us, frame, workspace)),
        };
        let mut status = Status {
            tick: self.tick,
            fault: sent.as_ref().err().copied(),
            clamped: false,
            slew_limited: false,
            deadline_missed: self.deadline.missed() != missed_before,
            deadlines_missed: self.deadline.missed(),
        };
        self.tick = self.tick.saturating_add(1);
        self.latched = status.fault;
        match sent {
            Ok(sent) => {
                (status.clamped, status.slew_limited) = (sent.clamped, sent.slew_limited);
                (sent.action, status)
            }
            Err(_) => (self.action_guard.send_safe(), status),
        }
    }

    /// What goes out when no observation came within `limit_us`: the safe action, with [`Fault::LinkSilent`] latched unless
    /// another fault was before.
    pub fn tick_without_observation(&mut self, limit_us: u32) -> (Action, Status) {
        let fault = *self.latched.get_or_insert(Fault::LinkSilent { limit_us });
        let status = Status {
            tick: self.tick,
            fault: Some(fault),
            clamped: false,
            slew_limited: false,
            deadline_missed: false,
            deadlines_missed: self.deadline.missed(),
        };
        self.tick = self.tick.saturating_add(1);
        (self.action_guard.send_safe(), status)
    }

    /// Starts a new episode: the plant is at rest, and everything of the last episode is forgotten.
    pub fn reset(&mut self) {
        self.rearm();
        self.action_guard.reset();
        self.deadline.reset();
        self.tick = 0;
    }

    /// Gives the controls back to the policy in mid-episode: forgets the latched fault and accepts any sequence number
    /// and any pause once, but still knows what was last sent, so that a held gripper stays held.
    pub fn rearm(&mut self) {
        self.latched = None;
        self.observation_guard.rearm();
        self.deadline.rearm();
    }

    fn fly(
        &mut self,
        now_us: u64,
        frame: &ObservationFrame<'_>,
        workspace: &mut Workspace,
    ) -> Result<Sent, Fault> {
        self.observation_guard.check(now_us, frame)?;
        let mut action = Action::new();
        let room = action.resize(self.policy.action_dim(), 0.0);
        room.map_err(|_| Fault::PolicyRefused)?;
        self.policy.act(frame.values, workspace, &mut action)?;
        self.action_guard.send(&action)
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

    fn action_dim(&self) -> usize {
        match self {
            Self::F32(policy) => policy.action_dim(),
            Self::Integer(policy) => policy.action_dim(),
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
