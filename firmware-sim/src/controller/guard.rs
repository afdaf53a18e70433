//! The checks around whatever acts: every observation before, every action after, and the clock.

use ted_policy::Terms;

use super::Status;
use crate::safety::{
    Action, ActionGuard, Deadline, Fault, ObservationFrame, ObservationGuard, Sent,
};

/// Stands between a plant and a policy of any kind. Once a check fails the reason is latched.
#[derive(Clone, Debug)]
pub struct Guard {
    observation_guard: ObservationGuard,
    action_guard: ActionGuard,
    deadline: Deadline,
    latched: Option<Fault>,
    tick: u32,
}

impl Guard {
    /// The checks of an artefact's contract, before the first tick.
    #[must_use]
    pub fn new(terms: &Terms<'_>) -> Self {
        let observation = terms.observation.iter();
        Self::of_parts(
            ObservationGuard::new(observation, terms.max_observation_age_us),
            ActionGuard::new(terms.action.iter()),
            terms.control_period_us,
        )
    }

    /// The same of a contract without an artefact.
    #[cfg(feature = "std")]
    #[must_use]
    pub fn of(contract: &ted_policy::Contract<'_>) -> Self {
        let observation = contract.observation.iter().copied();
        Self::of_parts(
            ObservationGuard::new(observation, contract.max_observation_age_us),
            ActionGuard::new(contract.action.iter().copied()),
            contract.control_period_us,
        )
    }

    fn of_parts(
        observation_guard: ObservationGuard,
        action_guard: ActionGuard,
        control_period_us: u32,
    ) -> Self {
        Self {
            observation_guard,
            action_guard,
            deadline: Deadline::new(control_period_us),
            latched: None,
            tick: 0,
        }
    }

    /// One control period: judges the observation, lets `act` fill in an action for it, in [-1, 1], judges that, and sends it in the
    /// robot's units.
    ///
    /// There is always an action. With a fault latched it is the safe one, and nobody is asked.
    #[inline]
    pub fn tick(
        &mut self,
        now_us: u64,
        frame: &ObservationFrame<'_>,
        act: impl FnOnce(&[f32], &mut [f32]) -> Result<(), Fault>,
    ) -> (Action, Status) {
        let missed_before = self.deadline.missed();
        let on_time = self.deadline.tick(now_us);
        let sent = match self.latched {
            Some(fault) => Err(fault),
            None => on_time.and_then(|()| self.fly(now_us, frame, act)),
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

    /// What the robot's numbers are to the policy, in [-1, 1]; numbers without a channel stay.
    #[must_use]
    pub fn unit(&self, action_env: &[f32]) -> Action {
        self.action_guard.unit(action_env)
    }

    /// Starts a new episode: the plant is at rest, and everything of the last episode is forgotten.
    pub fn reset(&mut self) {
        self.rearm();
        self.action_guard.reset();
        self.deadline.reset();
        self.tick = 0;
    }

    /// Gives the controls back in mid-episode: forgets the latched fault and accepts any sequence number and any pause
    /// once, but still knows what was last sent, so that a held gripper stays held.
    pub fn rearm(&mut self) {
        self.latched = None;
        self.observation_guard.rearm();
        self.deadline.rearm();
    }

    #[inline]
    fn fly(
        &mut self,
        now_us: u64,
        frame: &ObservationFrame<'_>,
        act: impl FnOnce(&[f32], &mut [f32]) -> Result<(), Fault>,
    ) -> Result<Sent, Fault> {
        self.observation_guard.check(now_us, frame)?;
        let mut action = Action::new();
        let room = action.resize(self.action_guard.channels(), 0.0);
        room.map_err(|_| Fault::PolicyRefused)?;
        act(frame.values, &mut action)?;
        self.action_guard.send(&action)
    }
}
