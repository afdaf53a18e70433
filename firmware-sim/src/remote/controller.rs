//! A controller at the other end of a link.

use std::io::{Read, Write};

use super::{Connection, DeviceHello, LinkErrors, RemoteError};
use crate::controller::Status;
use crate::device::message::{Acted, Floats, Health, Reply, Request, Score, Start};
use crate::rollout::{Debrief, DeviceLink, Pilot, Work};
use crate::safety::{Action, ObservationFrame};

/// Flies what is in the device's flash; to its caller, it is a controller like any other.
#[derive(Debug)]
pub struct RemoteController<S> {
    connection: Connection<S>,
    start: Start,
    bytes: Vec<u8>,
    work: Work,
    scoring: Work,
    score: Option<Score>,
    before: (Health, LinkErrors),
}

impl<S: Read + Write> RemoteController<S> {
    /// A controller on the device at the other end of this link; no episode is started yet.
    #[must_use]
    pub fn new(connection: Connection<S>, start: Start) -> Self {
        Self {
            connection,
            start,
            bytes: Vec::new(),
            work: Work::default(),
            scoring: Work::default(),
            score: None,
            before: (Health::default(), LinkErrors::default()),
        }
    }

    /// Who flies.
    pub fn hello(&self) -> &DeviceHello {
        self.connection.hello()
    }

    /// The connection below.
    pub fn connection(&mut self) -> &mut Connection<S> {
        &mut self.connection
    }

    /// Gives the connection back.
    pub fn into_connection(self) -> Connection<S> {
        self.connection
    }

    /// As [`Controller::rearm`](crate::controller::Controller::rearm).
    ///
    /// # Errors
    /// When the device cannot be reached, or flies no episode.
    pub fn rearm(&mut self) -> Result<(), RemoteError> {
        let asked = "re-arm the device";
        match self.connection.ask(asked, &Request::Rearm)? {
            Reply::Done => Ok(()),
            _ => Err(RemoteError::Unexpected { asked }),
        }
    }

    /// How the device and its link are.
    ///
    /// # Errors
    /// When the device cannot be reached.
    pub fn health(&mut self) -> Result<Health, RemoteError> {
        let asked = "ask the device how it is";
        match self.connection.ask(asked, &Request::Health)? {
            Reply::Health(health) => Ok(health),
            _ => Err(RemoteError::Unexpected { asked }),
        }
    }

    /// One tick with everything that the device says of it. `values` need not be an observation that can be flown on.
    ///
    /// # Errors
    /// When the device cannot be reached, or flies no episode.
    pub fn act(&mut self, now_us: u64, frame: &ObservationFrame<'_>) -> Result<Acted, RemoteError> {
        let asked = "fly on the device";
        self.bytes.clear();
        self.bytes
            .extend(frame.values.iter().flat_map(|value| value.to_le_bytes()));
        let Some(values) = Floats::from_le_bytes(&self.bytes) else {
            return Err(RemoteError::TooLong { asked });
        };
        let tick = Request::Tick {
            now_us,
            sequence: frame.sequence,
            stamp_us: frame.stamp_us,
            values,
        };
        match self.connection.ask(asked, &tick)? {
            Reply::Acted(acted) | Reply::Silent(acted) => Ok(acted),
            _ => Err(RemoteError::Unexpected { asked }),
        }
    }
}

impl<S: Read + Write> Pilot for RemoteController<S> {
    fn reset(&mut self) -> Result<(), RemoteError> {
        let asked = "start an episode on the device";
        match self.connection.ask(asked, &Request::Start(self.start))? {
            Reply::Done => {}
            _ => return Err(RemoteError::Unexpected { asked }),
        }
        // What the device said when the episode before ended is not about this one.
        self.connection.take_silent();
        (self.work, self.scoring, self.score) = (Work::default(), Work::default(), None);
        self.before = (self.health()?, self.connection.errors());
        Ok(())
    }

    fn tick(
        &mut self,
        now_us: u64,
        frame: &ObservationFrame<'_>,
    ) -> Result<(Action, Status), RemoteError> {
        let acted = self.act(now_us, frame)?;
        self.work.add(acted.work);
        if let Some(score) = acted.score {
            self.scoring.add(score.work);
            self.score = Some(score);
        }
        Ok((acted.action, acted.status))
    }

    fn debrief(&mut self) -> Result<Option<Debrief>, RemoteError> {
        let health = self.health()?;
        let (health_before, errors_before) = self.before;
        Ok(Some(Debrief {
            board: self.hello().board.clone(),
            score: self.score,
            work: self.work,
            scoring: self.scoring,
            work_hz: self.hello().work_hz,
            stack_high_water: health.stack_high_water,
            link: DeviceLink::between(
                &health_before.counters,
                &health.counters,
                errors_before,
                self.connection.errors(),
            ),
        }))
    }
}
