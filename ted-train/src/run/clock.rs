//! How long a run has been worked on, added up over the times that it was stopped and gone on with.

use std::time::Instant;

use firmware_sim::disk::WriteError;
use serde::{Deserialize, Serialize};

use super::RunFolder;

/// How long the run took: the one file in which two equal runs differ.
const TIME: &str = "time.json";

/// What the file says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Spent {
    /// Wall time of everything but the flight, in seconds. What was learned between the last checkpoint and a kill has to be
    /// learned again, and only the second time counts.
    pub seconds: f64,
}

/// A clock that goes on where the run was left.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    before: Spent,
    since: Instant,
}

impl Spent {
    /// What a run's folder says; none for a run of a time when nobody looked at the clock.
    #[must_use]
    pub fn of(folder: &RunFolder) -> Option<Self> {
        folder.read_json(TIME).ok()
    }
}

impl Clock {
    /// Starts it. One that cannot be read starts at zero.
    #[must_use]
    pub fn start(folder: &RunFolder) -> Self {
        Self {
            before: Spent::of(folder).unwrap_or_default(),
            since: Instant::now(),
        }
    }

    /// Writes down what it shows.
    ///
    /// # Errors
    /// When the disk is full or fails.
    pub fn note(&self, folder: &RunFolder) -> Result<(), WriteError> {
        let seconds = self.before.seconds + self.since.elapsed().as_secs_f64();
        // Tenths: nobody reads more, and the file stays readable.
        let seconds = (10.0 * seconds).round() / 10.0;
        folder.write_json(TIME, &Spent { seconds })
    }
}
