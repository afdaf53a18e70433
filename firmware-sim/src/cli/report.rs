//! What a flight says of itself: a table for people, one JSON object for machines.

use std::fmt::{self, Display};

use serde::Serialize;
use ted_policy::Artifact;

use super::device_report::DeviceReport;
use crate::bridge::Engine;
use crate::plants::replay::Difference;
use crate::rollout::{EpisodeReport, Flight, Summary, normalised_score};
use crate::worlds::World;

/// Everything `fly` reports.
#[derive(Debug, Serialize)]
pub struct Report {
    /// The artefact's path as given.
    pub policy: String,
    /// The task flown.
    pub task: String,
    /// The task that the policy was trained for.
    pub trained_for: String,
    /// The kind of plant.
    pub plant: String,
    /// How Meta-World was simulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub engine: Option<Engine>,
    /// The faults that were injected.
    pub injected: Vec<String>,
    /// The root of the episodes' seeds; a recording has none.
    pub seed: Option<u64>,
    /// The mean return.
    pub return_mean: f64,
    /// The returns' sample standard deviation.
    pub return_sd: f64,
    /// The best return in the dataset the policy was trained on.
    pub dataset_max_return: f64,
    /// The mean return as a share of that, or between those of the yardstick; none on another task.
    pub score: Option<f64>,
    /// The returns that a score of 0 and of 1 stand for, where the world says so.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub yardstick: Option<[f64; 2]>,
    /// The share of solved episodes.
    pub success_rate: f64,
    /// Episodes that latched a fault.
    pub faulted: usize,
    /// Median tick time.
    pub tick_p50_us: f64,
    /// The tick time that 99 of 100 ticks kept.
    pub tick_p99_us: f64,
    /// The longest tick.
    pub tick_max_us: f64,
    /// Where the replayed actions were farthest from the recorded ones.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_difference: Option<Difference>,
    /// What the boards say, if it was flown on boards.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub device: Option<DeviceReport>,
    /// One line per episode.
    pub episodes: Vec<EpisodeLine>,
}

/// One episode of a [`Report`].
#[derive(Debug, Serialize)]
pub struct EpisodeLine {
    seed: u64,
    #[serde(rename = "return")]
    return_true: f64,
    success: bool,
    ticks: u32,
    clamped_ticks: u32,
    slew_limited_ticks: u32,
    deadlines_missed: u32,
    fault: Option<FaultLine>,
}

#[derive(Debug, Serialize)]
struct FaultLine {
    tick: u32,
    code: u8,
    reason: String,
}

impl Report {
    /// Sums up a flight on the task that the artefact was trained for. The names of what was flown are the caller's to
    /// fill in.
    pub fn of(flight: &Flight, artifact: &Artifact<'_>) -> Self {
        let task = artifact.contract().task.to_owned();
        let dataset_max_return = artifact.provenance().dataset_return_max;
        let summary = Summary::of(&flight.episodes);
        let mut tick_us = flight
            .tick_times
            .percentiles_us(&[0.5, 0.99, 1.0])
            .into_iter();
        let mut next_us = || tick_us.next().unwrap_or(0.0);
        Self {
            policy: String::new(),
            trained_for: task.clone(),
            task,
            plant: String::new(),
            engine: None,
            injected: Vec::new(),
            seed: None,
            return_mean: summary.return_mean,
            return_sd: summary.return_sd,
            dataset_max_return,
            score: normalised_score(summary.return_mean, dataset_max_return),
            yardstick: None,
            success_rate: summary.success_rate,
            faulted: summary.faulted,
            tick_p50_us: next_us(),
            tick_p99_us: next_us(),
            tick_max_us: next_us(),
            largest_difference: None,
            device: None,
            episodes: flight.episodes.iter().map(EpisodeLine::of).collect(),
        }
    }

    /// The same in this world. The best return of one task's dataset measures no other task.
    pub fn in_world(self, world: &World) -> Self {
        Self {
            score: world.score(self.return_mean, self.dataset_max_return, &self.trained_for),
            yardstick: world.yardstick(),
            task: world.task(),
            plant: world.name(),
            ..self
        }
    }
}

impl EpisodeLine {
    fn of(report: &EpisodeReport) -> Self {
        let fault = report.fault.map(|latched| FaultLine {
            tick: latched.tick,
            code: latched.fault.code(),
            reason: latched.fault.to_string(),
        });
        Self {
            seed: report.seed,
            return_true: report.return_true,
            success: report.success,
            ticks: report.ticks,
            clamped_ticks: report.clamped_ticks,
            slew_limited_ticks: report.slew_limited_ticks,
            deadlines_missed: report.deadlines_missed,
            fault,
        }
    }
}

impl Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let flown = self.episodes.len();
        writeln!(f, "policy      {}", self.policy)?;
        write!(
            f,
            "flown       {flown} episodes of {} on {}",
            self.task, self.plant
        )?;
        if let Some(engine) = self.engine {
            write!(f, " ({engine} engine)")?;
        }
        match self.seed {
            Some(seed) => writeln!(f, ", root seed {seed}")?,
            None => writeln!(f)?,
        }
        if !self.injected.is_empty() {
            writeln!(f, "injected    {}", self.injected.join(", "))?;
        }
        writeln!(
            f,
            "return      {:.2} +- {:.2}",
            self.return_mean, self.return_sd
        )?;
        match (self.score, self.yardstick) {
            (Some(score), Some([zero, one])) => writeln!(
                f,
                "score       {score:.3}, where a return of {zero:.1} is 0 and {one:.1} is 1"
            )?,
            (Some(score), None) => writeln!(
                f,
                "score       {score:.3} of the dataset's best, {:.2}",
                self.dataset_max_return
            )?,
            (None, _) if self.task != self.trained_for => writeln!(
                f,
                "score       none: the policy was trained for {}",
                self.trained_for
            )?,
            (None, _) => writeln!(
                f,
                "score       none: the dataset's best return is {:.2}",
                self.dataset_max_return
            )?,
        }
        writeln!(f, "success     {:.1} %", 100.0 * self.success_rate)?;
        writeln!(
            f,
            "tick time   p50 {:.1} us, p99 {:.1} us, max {:.1} us",
            self.tick_p50_us, self.tick_p99_us, self.tick_max_us
        )?;
        let total = |count: fn(&EpisodeLine) -> u32| {
            self.episodes
                .iter()
                .map(|line| u64::from(count(line)))
                .sum::<u64>()
        };
        writeln!(
            f,
            "ticks       {}: {} clamped, {} slew-limited, {} late",
            total(|line| line.ticks),
            total(|line| line.clamped_ticks),
            total(|line| line.slew_limited_ticks),
            total(|line| line.deadlines_missed)
        )?;
        if let Some(worst) = self.largest_difference {
            writeln!(
                f,
                "difference  at most {:e} from the recorded actions (seed {}, step {}, action {})",
                worst.absolute, worst.seed, worst.step, worst.dimension
            )?;
        }
        if let Some(device) = &self.device {
            write!(f, "{device}")?;
        }
        write!(f, "faults      {} of {flown} episodes", self.faulted)?;
        for (index, line) in self.episodes.iter().enumerate() {
            if let Some(fault) = &line.fault {
                write!(
                    f,
                    "\n  episode {index} (seed {}), tick {}: ",
                    line.seed, fault.tick
                )?;
                write!(f, "code {}, {}", fault.code, fault.reason)?;
            }
        }
        Ok(())
    }
}
