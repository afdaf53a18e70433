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
    /// Channels that a fault leaves as they were sent last.
    held: Held,
    last_sent: Action,
}

/// A bit for each channel, the first one lowest: a device is short of memory.
type Held = u32;

#[derive(Clone, Copy, Debug)]
struct Limit {
    low: f32,
    high: f32,
    slew_per_tick: f32,
    /// What is sent at rest.
    rest: f32,
}

impl ActionGuard {
    /// A guard for a contract's channels, with the plant at rest: what is sent on a fault counts as the last action sent, for a
    /// channel that holds zero, or the end of the range nearest to it.
    #[must_use]
    pub fn new<'c>(channels: impl Iterator<Item = ActionChannel<'c>>) -> Self {
        let (mut limits, mut last_sent, mut held) = (Vec::new(), Vec::new(), 0);
        for (index, channel) in channels.enumerate() {
            let limit = Limit::of(&channel);
            held |= Held::from(matches!(channel.on_fault, SafeAction::HoldLast)) << index;
            // There is room: a contract has no more.
            limits.push(limit).ok();
            last_sent.push(limit.rest).ok();
        }
        Self {
            limits,
            held,
            last_sent,
        }
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
            let wanted = limit.map().robot(unit);
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
        let mut held = self.held;
        for (last, limit) in self.last_sent.iter_mut().zip(&self.limits) {
            if held & 1 == 0 {
                *last = limit.rest;
            }
            held >>= 1;
        }
        self.last_sent.clone()
    }

    /// What the robot's numbers are to the policy, in [-1, 1]; numbers without a channel stay.
    #[must_use]
    pub fn unit(&self, action_env: &[f32]) -> Action {
        let mut action_unit = Action::new();
        for (channel, &value) in action_env.iter().enumerate() {
            let limit = self.limits.get(channel);
            // Of numbers beyond the room nobody knows what they mean: the action is of another length then, and is refused.
            action_unit
                .push(limit.map_or(value, |limit| limit.map().unit(value)))
                .ok();
        }
        action_unit
    }

    /// Puts the plant at rest again.
    pub fn reset(&mut self) {
        for (last, limit) in self.last_sent.iter_mut().zip(&self.limits) {
            *last = limit.rest;
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
            // Nothing was sent yet that could be held: zero, or the end of the range nearest to it. Zero is in the range of a
            // channel that stops there.
            rest: match on_fault {
                SafeAction::Value(value) => value,
                SafeAction::Zero | SafeAction::HoldLast => 0.0_f32.max(low).min(high),
            },
        }
    }

    /// Between the policy's numbers and the robot's. Made when it is needed: a device has more time than memory.
    fn map(&self) -> ActionMap {
        ActionMap::new(self.low, self.high)
    }

    fn clamp(&self, value: f32) -> f32 {
        clamp(value, self.low, self.high)
    }

    /// A wanted value within reach goes out with its bits unchanged.
    fn slew(&self, last: f32, wanted: f32) -> f32 {
        let change = wanted - last;
        let reached = if change > self.slew_per_tick {
            last + self.slew_per_tick
        } else if change < -self.slew_per_tick {
            last - self.slew_per_tick
        } else {
            return wanted;
        };
        self.clamp(reached)
    }
}

/// Written out because `f32::clamp` panics on a range in disorder.
fn clamp(value: f32, low: f32, high: f32) -> f32 {
    if value < low {
        low
    } else if value > high {
        high
    } else {
        value
    }
}
