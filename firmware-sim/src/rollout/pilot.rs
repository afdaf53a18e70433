//! Whatever flies: a controller here, or one on a device.

use super::Debrief;
use crate::controller::{Controller, Status};
use crate::remote::RemoteError;
use crate::safety::{Action, ObservationFrame};

/// An action for every observation, and a status that says how it came about.
pub trait Pilot {
    /// Starts a new episode: the plant is at rest.
    ///
    /// # Errors
    /// When the pilot cannot be reached, or has nothing to fly.
    fn reset(&mut self) -> Result<(), RemoteError>;

    /// One control period; see [`Controller::tick`].
    ///
    /// # Errors
    /// When the pilot cannot be reached.
    fn tick(
        &mut self,
        now_us: u64,
        frame: &ObservationFrame<'_>,
    ) -> Result<(Action, Status), RemoteError>;

    /// What there is to say of the episode that is over, beyond what its plant and its statuses say.
    ///
    /// # Errors
    /// When the pilot cannot be reached.
    fn debrief(&mut self) -> Result<Option<Debrief>, RemoteError> {
        Ok(None)
    }
}

impl Pilot for Controller<'_> {
    fn reset(&mut self) -> Result<(), RemoteError> {
        self.reset();
        Ok(())
    }

    fn tick(
        &mut self,
        now_us: u64,
        frame: &ObservationFrame<'_>,
    ) -> Result<(Action, Status), RemoteError> {
        Ok(self.tick(now_us, frame))
    }
}
