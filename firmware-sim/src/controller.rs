//! The control loop: one observation in, one action out, every control period, whatever happens.
//!
//! A controller exists only for an artefact that passed its load gate. Once a check fails, the reason is latched and
//! the safe action goes out until someone decides otherwise.

use serde::{Deserialize, Serialize};
use ted_core::integer::IntegerScratch;
use ted_core::quantised::QuantisedPolicy;
use ted_core::{Policy, Scratch, ShapeError};
use ted_policy::{Artifact, ArtifactError};

use crate::safety::{
    Action, ActionGuard, Deadline, Fault, ObservationFrame, ObservationGuard, Sent,
};

/// In which numbers a controller computes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(feature = "std", derive(clap::ValueEnum))]
pub enum Numeric {
    /// Single precision, as trained.
    #[default]
    F32,
    /// The quantised networks: 8-bit weights, 16-bit activations.
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

/// A policy behind its checks, ready to fly.
///
/// It owns its scratch memory and copies the contract's numbers, so that a tick touches nothing but itself and the
/// borrowed weights.
#[derive(Clone, Debug)]
pub struct Controller<'a> {
    policy: NumericPolicy<'a>,
    observation_guard: ObservationGuard,
    action_guard: ActionGuard,
    deadline: Deadline,
    latched: Option<Fault>,
    tick: u32,
}

impl<'a> Controller<'a> {
    /// The load gate. What parsing proved holds already: shapes, finite weights, ordered ranges, a way to stop, at least
    /// one golden vector. Here this machine must compute the golden vectors bit for bit.
    ///
    /// # Errors
    /// The golden vector it failed on; the artefact does not fly then.
    pub fn load(artifact: &Artifact<'a>, numeric: Numeric) -> Result<Self, ArtifactError> {
        let terms = artifact.terms();
        Ok(Self {
            policy: NumericPolicy::load(artifact, numeric)?,
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
    pub fn tick(&mut self, now_us: u64, frame: &ObservationFrame<'_>) -> (Action, Status) {
        let missed_before = self.deadline.missed();
        let on_time = self.deadline.tick(now_us);
        let sent = match self.latched {
            Some(fault) => Err(fault),
            None => on_time.and_then(|()| self.fly(now_us, frame)),
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

    fn fly(&mut self, now_us: u64, frame: &ObservationFrame<'_>) -> Result<Sent, Fault> {
        self.observation_guard.check(now_us, frame)?;
        let mut action = Action::new();
        let room = action.resize(self.policy.action_dim(), 0.0);
        let acted = self.policy.act(frame.values, &mut action);
        if room.is_err() || acted.is_err() {
            return Err(Fault::PolicyRefused);
        }
        self.action_guard.send(&action)
    }
}

/// The policy in the numbers it is flown in, with its working memory.
// The larger variant cannot be boxed: a device has no heap.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Debug)]
enum NumericPolicy<'a> {
    F32 {
        policy: Policy<'a>,
        scratch: Scratch,
    },
    Integer {
        policy: QuantisedPolicy<'a>,
        scratch: IntegerScratch,
    },
}

impl<'a> NumericPolicy<'a> {
    /// The policy of an artefact whose golden vectors this machine computes in these numbers.
    fn load(artifact: &Artifact<'a>, numeric: Numeric) -> Result<Self, ArtifactError> {
        match numeric {
            Numeric::F32 => {
                let mut scratch = Scratch::new();
                artifact.verify_golden(&mut scratch)?;
                let policy = artifact.policy();
                Ok(Self::F32 { policy, scratch })
            }
            Numeric::Integer => {
                let mut scratch = IntegerScratch::new();
                artifact.verify_integer_golden(&mut scratch)?;
                let policy = artifact.integer_policy().ok_or(ArtifactError::NoIntegers)?;
                Ok(Self::Integer { policy, scratch })
            }
        }
    }

    fn action_dim(&self) -> usize {
        match self {
            Self::F32 { policy, .. } => policy.action_dim(),
            Self::Integer { policy, .. } => policy.action_dim(),
        }
    }

    fn act(&mut self, obs_raw: &[f32], action_unit: &mut [f32]) -> Result<(), ShapeError> {
        match self {
            Self::F32 { policy, scratch } => policy.act(obs_raw, scratch, action_unit),
            Self::Integer { policy, scratch } => policy.act(obs_raw, scratch, action_unit),
        }
    }
}
