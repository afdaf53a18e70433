//! A short flight in which something happens at one tick, watched from both sides.

use std::io::{Read, Write};

use ted_core::MAX_ACTION;
use ted_policy::{ActionChannel, Artifact, SafeAction};

use super::DrillError;
use crate::bench::Disturbed;
use crate::controller::{Controller, Numeric, Status};
use crate::plant::Plant;
use crate::plants::fault::{FaultInjector, FaultPlan};
use crate::plants::toy::ToyPlant;
use crate::remote::{RemoteController, RemoteError};
use crate::rollout::Pilot;
use crate::safety::{Action, Fault, ObservationFrame};

/// The tick at which something happens.
pub(super) const STRIKE: u32 = 4;
/// From this tick on a latched controller is re-armed before every tick.
pub(super) const REARM: u32 = 8;
/// The flight's length in ticks.
pub(super) const END: u32 = 20;

const SEED: u64 = 1;

/// The end of a slew-limited step is rounded.
const SLEW_ROUNDING: f32 = 1e-6;

/// A device's controller over a line that can be disturbed.
pub(super) type Remote<L> = RemoteController<Disturbed<L>>;

/// What came of a flight.
#[derive(Clone, Debug, Default)]
pub(super) struct Flown {
    /// The last action before anything happened.
    pub(super) before: Action,
    /// The action that was sent where it happened: at its tick, or at the one that latched.
    pub(super) answer: Action,
    /// The tick that latched a fault, and which.
    pub(super) latched: Option<(u32, Fault)>,
    /// Ticks from the first re-arming to the first one flown.
    pub(super) recovered: Option<u32>,
    /// Actions that must not go out.
    pub(super) unsafe_actions: u32,
    /// Ticks that a controller on this machine, given the same observations, would have flown otherwise.
    pub(super) other_than_host: u32,
}

/// What is done to the link before the tick [`STRIKE`]. If it brings an answer by itself, that is the device's to a tick
/// that never comes.
pub(super) type Strike<'s, L> = &'s mut dyn FnMut(&mut Remote<L>) -> Result<Struck, RemoteError>;

/// What a strike did.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Struck {
    /// The tick comes.
    TickFollows,
    /// The device acted by itself after so many microseconds.
    Alone(Action, Status, u32),
}

/// Flies the toy from one seed, with this fault in its observations if there is one.
pub(super) fn fly<L: Read + Write>(
    remote: &mut Remote<L>,
    artifact: &Artifact<'_>,
    plan: Option<FaultPlan>,
    strike: Strike<'_, L>,
) -> Result<Flown, DrillError> {
    let contract = artifact.contract();
    // On another contract there is nothing to compare; the drill never flies one.
    let mut twin = Controller::load(artifact, Numeric::F32).ok();
    let mut plant = FaultInjector::new(ToyPlant::new(), plan.into_iter().collect(), 0);
    plant.reset(SEED)?;
    remote.reset()?;
    let mut flown = Flown::default();
    let mut last = Action::new();
    for tick in 0..END {
        if tick >= REARM && flown.latched.is_some() && flown.recovered.is_none() {
            remote.rearm()?;
            twin.as_mut().map(Controller::rearm);
        }
        let struck = match tick {
            STRIKE => strike(remote)?,
            _ => Struck::TickFollows,
        };
        let observed = plant.observe()?;
        let now_us = plant.now_us();
        let frame = ObservationFrame {
            sequence: observed.sequence,
            stamp_us: observed.stamp_us,
            values: &observed.values,
        };
        let (action, status, expected) = match struck {
            Struck::TickFollows => {
                let (action, status) = remote.tick(now_us, &frame)?;
                let expected = twin.as_mut().map(|twin| twin.tick(now_us, &frame));
                (action, status, expected)
            }
            Struck::Alone(action, status, limit_us) => {
                let silent = |twin: &mut Controller<'_>| twin.tick_without_observation(limit_us);
                (action, status, twin.as_mut().map(silent))
            }
        };
        flown.other_than_host += u32::from(expected != Some((action.clone(), status)));
        let safe = may_go_out(&contract.action, &last, &action, status.fault.is_some());
        flown.unsafe_actions += u32::from(!safe);
        if tick + 1 == STRIKE {
            flown.before.clone_from(&action);
        }
        if tick == STRIKE || (flown.latched.is_none() && status.fault.is_some()) {
            flown.answer.clone_from(&action);
        }
        flown.latched = flown.latched.or(status.fault.map(|fault| (tick, fault)));
        if tick >= REARM && flown.latched.is_some() && status.fault.is_none() {
            flown.recovered = flown.recovered.or(Some(tick - REARM));
        }
        plant.apply(&action)?;
        last = action;
    }
    Ok(flown)
}

/// Whether an action is finite, in range, and either the safe one or within reach of the last.
fn may_go_out(
    channels: &[ActionChannel<'_>],
    last: &Action,
    action: &Action,
    faulted: bool,
) -> bool {
    let rest = [0.0; MAX_ACTION];
    let last = if last.is_empty() { &rest[..] } else { last };
    let allowed = |((channel, value), last): ((&ActionChannel<'_>, &f32), &f32)| {
        let reach = channel.slew_per_tick + SLEW_ROUNDING;
        value.is_finite()
            && (channel.low..=channel.high).contains(value)
            && match (faulted, channel.on_fault) {
                (true, SafeAction::Zero) => *value == 0.0,
                (true, SafeAction::Value(safe)) => *value == safe,
                (true, SafeAction::HoldLast) => value == last,
                (false, _) => (value - last).abs() <= reach,
            }
    };
    action.len() == channels.len() && channels.iter().zip(action).zip(last).all(allowed)
}
