//! What a device says of the episodes it flew: its work, its stack, its link, and what it thinks of them.

use crate::device::Counters;
use crate::device::message::Score;
use crate::remote::LinkErrors;

/// What something took on a device, in ticks of its counter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// How often it was done.
    pub times: u64,
    /// All together.
    pub total: u64,
    /// The most it ever took.
    pub max: u32,
}

impl Work {
    /// Counts one more.
    pub fn add(&mut self, work: u32) {
        self.append(Self {
            times: 1,
            total: u64::from(work),
            max: work,
        });
    }

    /// Counts those too.
    pub fn append(&mut self, other: Self) {
        self.times += other.times;
        self.total += other.total;
        self.max = self.max.max(other.max);
    }

    /// What it took on average; 0 if it was never done.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.total as f64 / self.times.max(1) as f64
    }
}

/// What went wrong on a link, seen from both ends. None of it shows in an episode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DeviceLink {
    /// Requests that the host had to send again.
    pub retries: u64,
    /// Damaged or overlong frames, at either end.
    pub damaged: u64,
    /// Requests that the device had seen before, and replies that the host had.
    pub repeated: u64,
    /// Requests that came to the device too late, or never.
    pub lost: u64,
}

impl DeviceLink {
    /// What went wrong between two readings of the counters at each end.
    #[must_use]
    pub fn between(
        before: &Counters,
        after: &Counters,
        host_before: LinkErrors,
        host_after: LinkErrors,
    ) -> Self {
        // A device that was started anew counts from zero.
        let since = |after: u32, before: u32| u64::from(after.checked_sub(before).unwrap_or(after));
        let damaged = |counters: &Counters| {
            let Counters {
                crc_errors,
                too_long,
                malformed,
                link_errors,
                ..
            } = *counters;
            [crc_errors, too_long, malformed, link_errors]
                .iter()
                .fold(0, |sum: u32, &count| sum.saturating_add(count))
        };
        Self {
            retries: since(host_after.retries, host_before.retries),
            damaged: since(damaged(after), damaged(before))
                + since(
                    damaged(&host_after.received),
                    damaged(&host_before.received),
                ),
            repeated: since(after.duplicates, before.duplicates)
                + since(host_after.stale, host_before.stale),
            lost: since(after.reordered, before.reordered) + since(after.dropped, before.dropped),
        }
    }

    /// Whether nothing went wrong.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        *self == Self::default()
    }

    fn append(&mut self, other: Self) {
        self.retries += other.retries;
        self.damaged += other.damaged;
        self.repeated += other.repeated;
        self.lost += other.lost;
    }
}

/// What a device says of one episode.
#[derive(Clone, Debug, PartialEq)]
pub struct Debrief {
    /// What the board calls itself.
    pub board: String,
    /// What it thinks of the episode, if its artefact has a reward ensemble and TED's border.
    pub score: Option<Score>,
    /// What its ticks took.
    pub work: Work,
    /// What scoring them took.
    pub scoring: Work,
    /// Ticks of the counter in a second; 0 if that is not known.
    pub work_hz: u32,
    /// The most stack that was ever in use, in bytes; 0 if that is not known.
    pub stack_high_water: u32,
    /// What went wrong on the link meanwhile.
    pub link: DeviceLink,
}

/// What the devices of a flight say of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DeviceSummary {
    /// What the boards call themselves.
    pub board: String,
    /// What they think of the episodes, in the order of the flight; empty if it cannot score.
    pub scores: Vec<Score>,
    /// What ticks took.
    pub work: Work,
    /// What scoring took.
    pub scoring: Work,
    /// Ticks of the counter in a second; 0 if that is not known.
    pub work_hz: u32,
    /// The most stack that was in use on any of them, in bytes; 0 if that is not known.
    pub stack_high_water: u32,
    /// What went wrong on the links.
    pub link: DeviceLink,
}

impl DeviceSummary {
    /// Sums up; nothing when no device flew.
    #[must_use]
    pub fn of(debriefs: impl IntoIterator<Item = Debrief>) -> Option<Self> {
        let mut summary = None;
        for debrief in debriefs {
            let sum: &mut Self = summary.get_or_insert_default();
            sum.board = debrief.board;
            sum.scores.extend(debrief.score);
            sum.work.append(debrief.work);
            sum.scoring.append(debrief.scoring);
            sum.work_hz = debrief.work_hz;
            sum.stack_high_water = sum.stack_high_water.max(debrief.stack_high_water);
            sum.link.append(debrief.link);
        }
        summary
    }
}
