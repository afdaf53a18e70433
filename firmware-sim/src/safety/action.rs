//! Whether and how an action may go out: finite, inside the contract's range, and not too far from the last one sent.

use heapless::Vec;
use ted_core::MAX_ACTION;
use ted_policy::{ActionChannel, ActionMap, SafeAction};

use super::Fault;

/// One value per action channel of the contract, in its unit.
pub type Action = Vec<f32, MAX_ACTION>;

/// An action that may go out, and what had to be done to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Sent {
    /// What goes out.
    pub action: Action,
    /// Whether a value was outside its range.
    pub clamped: bool,
    /// Whether a value was too far from the last one sent.
    pub slew_limited: bool,
}

/// What the contract promises about actions, and the last one sent.
#[derive(Clone, Debug)]
pub struct ActionGuard {
    limits: Vec<Limit, MAX_ACTION>,
    last_sent: Action,
}

#[derive(Clone, Copy, Debug)]
struct Limit {
    low: f32,
    high: f32,
    slew_per_tick: f32,
    on_fault: SafeAction,
    map: ActionMap,
}

impl ActionGuard {
    /// A guard for a contract's channels, with the plant at rest: what is sent on a fault counts as the last action sent, for a
    /// channel that holds zero, or the end of the range nearest to it.
    #[must_use]
    pub fn new<'c>(channels: impl Iterator<Item = ActionChannel<'c>>) -> Self {
        let (mut limits, mut last_sent) = (Vec::new(), Vec::new());
        for limit in channels.map(|channel| Limit::of(&channel)) {
            // There is room: a contract has no more.
            limits.push(limit).ok();
            last_sent.push(limit.rest()).ok();
        }
        Self { limits, last_sent }
    }

    /// Values in an action.
    #[must_use]
    pub fn channels(&self) -> usize {
        self.limits.len()
    }

    /// What the policy wants, in [-1, 1], as the nearest action that may go out.
    ///
    /// # Errors
    /// When a wanted value is not finite; nothing is sent then.
    pub fn send(&mut self, action_unit: &[f32]) -> Result<Sent, Fault> {
        if let Some(index) = action_unit.iter().position(|value| !value.is_finite()) {
            return Err(Fault::ActionNotFinite { index });
        }
        let (mut clamped, mut slew_limited) = (false, false);
        for ((last, limit), &unit) in self.last_sent.iter_mut().zip(&self.limits).zip(action_unit) {
            let wanted = limit.map.robot(unit);
            let inside = limit.clamp(wanted);
            let reached = limit.slew(*last, inside);
            clamped |= inside != wanted;
            slew_limited |= reached != inside;
            *last = reached;
        }
        Ok(Sent {
            action: self.last_sent.clone(),
            clamped,
            slew_limited,
        })
    }

    /// The action that stops the plant: every channel at zero, at the value that the contract says, or as it was last sent.
    ///
    /// It stops at once: the slew limit protects against a jumping policy and is not applied to stopping.
    pub fn send_safe(&mut self) -> Action {
        for (last, limit) in self.last_sent.iter_mut().zip(&self.limits) {
            if limit.on_fault != SafeAction::HoldLast {
                *last = limit.rest();
            }
        }
        self.last_sent.clone()
    }

    /// Puts the plant at rest again.
    pub fn reset(&mut self) {
        for (last, limit) in self.last_sent.iter_mut().zip(&self.limits) {
            *last = limit.rest();
        }
    }
}

impl Limit {
    fn of(channel: &ActionChannel<'_>) -> Self {
        let ActionChannel {
            low,
            high,
            slew_per_tick,
            on_fault,
            ..
        } = *channel;
        Self {
            low,
            high,
            slew_per_tick,
            on_fault,
            map: channel.map(),
        }
    }

    /// What the contract says for a fault. Nothing was sent yet that could be held: zero, or the end of the range nearest to it.
    fn rest(&self) -> f32 {
        match self.on_fault {
            SafeAction::Zero | SafeAction::HoldLast => self.clamp(0.0),
            SafeAction::Value(value) => value,
        }
    }

    /// Written out because `f32::clamp` panics on a range in disorder.
    fn clamp(&self, value: f32) -> f32 {
        if value < self.low {
            self.low
        } else if value > self.high {
            self.high
        } else {
            value
        }
    }

    /// A wanted value within reach goes out with its bits unchanged.
    fn slew(&self, last: f32, wanted: f32) -> f32 {
        let change = wanted - last;
        if change > self.slew_per_tick {
            self.clamp(last + self.slew_per_tick)
        } else if change < -self.slew_per_tick {
            self.clamp(last - self.slew_per_tick)
        } else {
            wanted
        }
    }
}
