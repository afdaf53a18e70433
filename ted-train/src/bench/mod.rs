//! How fast the three things are that a person waits for: an update of the learner, an action, a step of the simulator.
//!
//! Whatever is compared is measured in turn in one process, so that what disturbs one disturbs the other, and the median of
//! the repetitions counts.

mod act;
mod iql;

pub use iql::{Learners, replay, synthetic};

use firmware_sim::bridge::environment::{self, SetupError};
use firmware_sim::bridge::{BridgeError, speed};
use firmware_sim::interrupt;
use firmware_sim::progress::Audience;
use serde::Serialize;
use ted_core::ShapeError;
use ted_core::integer::IntegerError;

use crate::dataset::DatasetError;

/// What to measure, and for how long.
#[derive(Clone, Debug)]
pub struct BenchConfig {
    /// Updates in one repetition.
    pub updates: u32,
    /// Repetitions of everything but the simulator.
    pub repetitions: u32,
    /// Steps of the simulator in one of its rounds; none to leave it out.
    pub simulator_steps: Option<u32>,
    /// The task that the simulator steps.
    pub task: String,
}

/// Times of one thing, in seconds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Timing {
    /// What was measured.
    pub what: String,
    /// Median time of one.
    pub median_s: f64,
    /// Fastest repetition.
    pub fastest_s: f64,
    /// Slowest repetition.
    pub slowest_s: f64,
    /// Repetitions.
    pub repetitions: usize,
}

/// How much faster one thing is than another.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ratio {
    /// What is compared with what.
    pub what: String,
    /// The first one's speed as a multiple of the second one's.
    pub ratio: f64,
}

/// Everything that was measured.
#[derive(Clone, Debug, Serialize)]
pub struct Bench {
    /// The processor.
    pub machine: String,
    /// Times.
    pub timings: Vec<Timing>,
    /// What they say of each other.
    pub ratios: Vec<Ratio>,
}

/// Why nothing was measured.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// The synthetic dataset.
    #[error(transparent)]
    Dataset(#[from] DatasetError),
    /// The synthetic policy.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// The same in integers.
    #[error(transparent)]
    Integer(#[from] IntegerError),
    /// There is no simulator.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The threads of the learners.
    #[error("cannot start threads: {0}")]
    Threads(rayon::ThreadPoolBuildError),
    /// The simulator failed.
    #[error(transparent)]
    Bridge(#[from] BridgeError),
    /// Somebody asked to stop.
    #[error("stopped on request; nothing was changed")]
    Interrupted,
}

impl Timing {
    /// From the seconds that one took in each repetition; at least one is needed.
    fn new(what: &str, mut seconds: Vec<f64>) -> Self {
        seconds.sort_by(f64::total_cmp);
        let (count, at) = (seconds.len(), |i: usize| {
            seconds.get(i).copied().unwrap_or(0.0)
        });
        Self {
            what: what.to_owned(),
            median_s: (at(count.saturating_sub(1) / 2) + at(count / 2)) / 2.0,
            fastest_s: at(0),
            slowest_s: at(count.saturating_sub(1)),
            repetitions: count,
        }
    }
}

/// Measures.
///
/// # Errors
/// When there is no simulator to measure, or on request.
pub fn bench(config: &BenchConfig, audience: Audience) -> Result<Bench, BenchError> {
    let mut timings = iql::measure(config, audience)?;
    let mut ratios = Vec::new();
    if let Some((fused, others)) = timings.split_first() {
        ratios.extend(others.iter().map(|other| Ratio {
            what: format!("{} over {}", fused.what, other.what),
            ratio: other.median_s / fused.median_s,
        }));
    }
    let [float, integer] = act::measure(config.repetitions)?;
    ratios.push(Ratio {
        what: "an action, integers over f32".to_owned(),
        ratio: float.median_s / integer.median_s,
    });
    timings.extend([float, integer]);
    if let Some(steps) = config.simulator_steps {
        let environment = environment::ensure(audience)?;
        audience.note(&format!(
            "step {} through the bridge and without it",
            config.task
        ));
        let speed = speed::measure(&environment, &config.task, steps)?;
        let timing = |what, time: std::time::Duration| Timing::new(what, vec![time.as_secs_f64()]);
        timings.push(timing(
            "simulator step through the bridge (best)",
            speed.bridge,
        ));
        timings.push(timing(
            "simulator step in Python, gym.make (best)",
            speed.package,
        ));
        timings.push(timing(
            "simulator step in Python, worker's task (best)",
            speed.task,
        ));
        for (what, ratio) in [
            ("simulator, bridge over gym.make", speed.of_package()),
            ("simulator, bridge over worker's task", speed.of_task()),
        ] {
            ratios.push(Ratio {
                what: what.to_owned(),
                ratio,
            });
        }
    }
    Ok(Bench {
        machine: crate::doctor::processor(),
        timings,
        ratios,
    })
}

fn stop_if_asked() -> Result<(), BenchError> {
    if interrupt::requested() {
        Err(BenchError::Interrupted)
    } else {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_of_an_even_number_lies_between_the_middle_two() {
        let timing = Timing::new("x", vec![4.0, 1.0, 2.0, 3.0]);
        assert_eq!(
            (timing.fastest_s, timing.median_s, timing.slowest_s),
            (1.0, 2.5, 4.0)
        );
        assert_eq!(Timing::new("x", vec![3.0, 1.0, 2.0]).median_s, 2.0);
    }
}
