//! The policy in the cockpit, behind the checks that a controller has.

use firmware_sim::controller::{Guard, Status};
use firmware_sim::remote::RemoteError;
use firmware_sim::rollout::Pilot;
use firmware_sim::safety::{Action, ObservationFrame};
use ted_policy::Contract;

use super::{Oppo, Player};

/// Flies a sequence policy from this machine: every observation and every action is judged as a controller judges them.
#[derive(Clone, Debug)]
pub struct SequencePilot<'a> {
    player: Player<'a>,
    guard: Guard,
}

impl<'a> SequencePilot<'a> {
    /// A pilot at rest. The contract must be of the dataset that the policy was learned from.
    #[must_use]
    pub fn new(oppo: &'a Oppo, contract: &Contract<'_>) -> Self {
        Self {
            player: Player::new(oppo),
            guard: Guard::of(contract),
        }
    }
}

impl Pilot for SequencePilot<'_> {
    fn reset(&mut self) -> Result<(), RemoteError> {
        self.player.reset();
        self.guard.reset();
        Ok(())
    }

    fn tick(
        &mut self,
        now_us: u64,
        frame: &ObservationFrame<'_>,
    ) -> Result<(Action, Status), RemoteError> {
        let player = &mut self.player;
        Ok(self.guard.tick(now_us, frame, |obs_raw, action_env| {
            action_env.copy_from_slice(&player.act(obs_raw));
            Ok(())
        }))
    }
}
