//! How much of the simulator's speed the bridge leaves: the same steps through it and without it.

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use super::environment::Environment;
use super::error::BridgeError;
use super::message::Step;
use super::worker::{Worker, settings};

const ACTION: [f32; 4] = [0.1, -0.1, 0.1, 0.0];
const SCRIPT: &str = "speed.py";
/// Each way is measured this often, in turn, and the best counts: whatever disturbs a measurement makes it slower.
const ROUNDS: usize = 5;

/// Times of one step of a task.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Speed {
    /// Through the bridge, one request per step.
    pub bridge: Duration,
    /// Inside a Python process, with `gym.make("Meta-World/MT1")`.
    pub in_process: Duration,
}

impl Speed {
    /// Steps per second through the bridge, as a share of those inside the process.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.in_process.as_secs_f64() / self.bridge.as_secs_f64()
    }
}

/// Measures a task over this many steps per round.
///
/// # Errors
/// When the worker fails, or the Python process that measures.
pub fn measure(environment: &Environment, task: &str, steps: u32) -> Result<Speed, BridgeError> {
    let mut speed = Speed {
        bridge: Duration::MAX,
        in_process: Duration::MAX,
    };
    for _ in 0..ROUNDS {
        speed.in_process = speed
            .in_process
            .min(without_bridge(environment, task, steps)?);
        speed.bridge = speed.bridge.min(through_bridge(environment, task, steps)?);
    }
    Ok(speed)
}

fn through_bridge(
    environment: &Environment,
    task: &str,
    steps: u32,
) -> Result<Duration, BridgeError> {
    let mut worker = Worker::spawn(environment)?;
    let horizon = worker.open(task)?.horizon;
    let (mut spent, mut left, mut step) = (Duration::ZERO, steps, Step::default());
    while left > 0 {
        worker.reset(1)?;
        let chunk = left.min(horizon);
        let begin = Instant::now();
        for _ in 0..chunk {
            worker.step_into(&ACTION, &mut step)?;
        }
        spent += begin.elapsed();
        left -= chunk;
    }
    Ok(spent / steps.max(1))
}

fn without_bridge(
    environment: &Environment,
    task: &str,
    steps: u32,
) -> Result<Duration, BridgeError> {
    let python = environment.python();
    let spawn_error = |source| BridgeError::Spawn {
        python: python.to_owned(),
        source,
    };
    let output = settings(&mut Command::new(python))
        .arg("-Es")
        .arg(environment.worker().with_file_name(SCRIPT))
        .args([task, &steps.to_string()])
        .current_dir(environment.scratch())
        .stdin(Stdio::null())
        .output()
        .map_err(spawn_error)?;
    let answer = String::from_utf8_lossy(&output.stdout);
    let seconds = answer.trim().parse().ok();
    let duration = seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    duration.ok_or_else(|| {
        let words = String::from_utf8_lossy(&output.stderr);
        spawn_error(std::io::Error::other(words.trim().to_owned()))
    })
}
