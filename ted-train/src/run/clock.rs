//! How long a run has been worked on, added up over the times that it was stopped and gone on with.

use std::path::PathBuf;
use std::time::Instant;

use firmware_sim::disk::WriteError;
use serde::{Deserialize, Serialize};

use super::RunFolder;

/// Never compared between runs: it is about the machine and its other work.
const TIME: &str = "time.json";

/// Wall time of a run in seconds, beside whatever else the machine did. Export and flight are not counted, and neither is
/// what was lost by a kill and had to be done again.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Spent {
    /// Everything before the policy: questions, reward, labels and discounts.
    pub reward_s: f64,
    /// The updates of the policy.
    pub policy_s: f64,
    /// The run that the reward was taken from, whose time `reward_s` is then.
    pub reward_of: Option<PathBuf>,
}

/// A phase of a run under way.
#[derive(Clone, Debug)]
pub struct Clock {
    before: Spent,
    phase: Phase,
    since: Instant,
}

/// What the time is spent on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// All that comes before the policy.
    Reward,
    /// The updates of the policy.
    Policy,
}

impl Spent {
    /// What a run's folder says; none for a run of a time when nobody looked at the clock.
    #[must_use]
    pub fn of(folder: &RunFolder) -> Option<Self> {
        folder.read_json(TIME).ok()
    }

    /// Writes it into a run's folder.
    ///
    /// # Errors
    /// When the disk is full or fails.
    pub fn write(&self, folder: &RunFolder) -> Result<(), WriteError> {
        folder.write_json(TIME, self)
    }
}

impl Clock {
    /// Starts it where the run was left. What cannot be read was zero.
    #[must_use]
    pub fn start(folder: &RunFolder, phase: Phase) -> Self {
        Self {
            before: Spent::of(folder).unwrap_or_default(),
            phase,
            since: Instant::now(),
        }
    }

    /// What it shows.
    #[must_use]
    pub fn spent(&self) -> Spent {
        let mut spent = self.before.clone();
        let field = match self.phase {
            Phase::Reward => &mut spent.reward_s,
            Phase::Policy => &mut spent.policy_s,
        };
        // Tenths: nobody reads more.
        *field = (10.0 * (*field + self.since.elapsed().as_secs_f64())).round() / 10.0;
        spent
    }
}

#[cfg(test)]
mod tests {
    use std::thread::sleep;
    use std::time::Duration;

    use super::*;
    use crate::config::Preset;
    use crate::run::DatasetReference;

    #[test]
    fn a_clock_goes_on_where_the_run_was_left_and_each_phase_has_its_own() {
        let temporary = tempfile::tempdir().unwrap();
        let dataset = DatasetReference {
            id: "ted/x-v0".to_owned(),
            digest: String::new(),
            path: PathBuf::new(),
        };
        let config = Preset::True.config();
        let folder = RunFolder::begin(temporary.path(), &config, &dataset).unwrap();
        assert_eq!(Spent::of(&folder), None);
        let before = Spent {
            reward_s: 7.0,
            policy_s: 3.0,
            reward_of: Some(PathBuf::from("there")),
        };
        before.write(&folder).unwrap();
        let clock = Clock::start(&folder, Phase::Policy);
        sleep(Duration::from_millis(200));
        let spent = clock.spent();
        assert!(spent.policy_s >= 3.2, "{spent:?}");
        assert_eq!((spent.reward_s, &spent.reward_of), (7.0, &before.reward_of));
        spent.write(&folder).unwrap();
        let later = Clock::start(&folder, Phase::Reward).spent();
        assert!(later.reward_s >= 7.0);
        assert_eq!(later.policy_s, spent.policy_s);
    }
}
