//! How much of the simulator's speed the bridge leaves: the same steps through it and without it.

use std::io::Read;
use std::os::unix::process::CommandExt;
use std::process::{Child, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use super::environment::{Environment, call};
use super::error::BridgeError;
use super::worker::{Worker, settings};
use crate::interrupt;
use crate::last_words::Listener;

const ACTION: [f32; 4] = [0.1, -0.1, 0.1, 0.0];
const SCRIPT: &str = "speed.py";
/// Each way is measured this often, in turn, and the best counts: whatever disturbs a measurement makes it slower.
const ROUNDS: usize = 5;
/// How soon the end of the Python process and a request to stop are noticed.
const SLICE: Duration = Duration::from_millis(50);

/// Times of one step of a task.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Speed {
    /// Through the bridge, one request per step.
    pub bridge: Duration,
    /// Inside a Python process, with `gym.make("Meta-World/MT1")`: the package as its users have it.
    pub package: Duration,
    /// Inside a Python process, with the very environment that a worker steps: what is left is the bridge alone.
    pub task: Duration,
}

impl Speed {
    /// Steps per second through the bridge, as a share of those of the package.
    #[must_use]
    pub fn of_package(&self) -> f64 {
        self.package.as_secs_f64() / self.bridge.as_secs_f64()
    }

    /// Steps per second through the bridge, as a share of those of the same environment inside Python.
    #[must_use]
    pub fn of_task(&self) -> f64 {
        self.task.as_secs_f64() / self.bridge.as_secs_f64()
    }
}

/// Measures a task over this many steps per round.
///
/// # Errors
/// When the worker fails, or the Python process that measures, or on request.
pub fn measure(environment: &Environment, task: &str, steps: u32) -> Result<Speed, BridgeError> {
    let mut speed = Speed {
        bridge: Duration::MAX,
        package: Duration::MAX,
        task: Duration::MAX,
    };
    for _ in 0..ROUNDS {
        let [package, task_itself] = without_bridge(environment, task, steps)?;
        speed.package = speed.package.min(package);
        speed.task = speed.task.min(task_itself);
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
    let (mut spent, mut left) = (Duration::ZERO, steps);
    while left > 0 {
        worker.reset(0, 1)?;
        let chunk = left.min(horizon);
        let begin = Instant::now();
        for _ in 0..chunk {
            worker.step(&ACTION)?;
        }
        spent += begin.elapsed();
        left -= chunk;
    }
    Ok(spent / steps.max(1))
}

/// The package's time and the task's. The process has the lifetime of a worker: it ends with us, and on request.
fn without_bridge(
    environment: &Environment,
    task: &str,
    steps: u32,
) -> Result<[Duration; 2], BridgeError> {
    let spawn_error = |source| BridgeError::Spawn {
        python: environment.python().to_owned(),
        source,
    };
    let mut child = settings(&mut call(environment.python()))
        .arg("-Es")
        .arg(environment.worker().with_file_name(SCRIPT))
        .args([task, &steps.to_string(), environment.engine().name()])
        .current_dir(environment.scratch())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .process_group(0)
        .spawn()
        .map_err(spawn_error)?;
    let (Some(mut stdout), Some(stderr)) = (child.stdout.take(), child.stderr.take()) else {
        return Err(spawn_error(std::io::ErrorKind::BrokenPipe.into()));
    };
    let stderr = Listener::new(stderr);
    wait(&mut child).map_err(spawn_error)?;
    if interrupt::requested() {
        return Err(BridgeError::Interrupted);
    }
    let mut answer = String::new();
    // Whatever is not read is not understood either.
    stdout.read_to_string(&mut answer).ok();
    parse(&answer).ok_or_else(|| BridgeError::Died {
        during: "time the simulator",
        status: child
            .wait()
            .map_or_else(|error| error.to_string(), |status| status.to_string()),
        last_words: stderr.words(),
    })
}

/// Until it ends, by itself or because the person asked to stop.
fn wait(child: &mut Child) -> std::io::Result<()> {
    while child.try_wait()?.is_none() {
        if interrupt::requested() {
            child.kill()?;
            child.wait()?;
            break;
        }
        thread::sleep(SLICE);
    }
    Ok(())
}

fn parse(answer: &str) -> Option<[Duration; 2]> {
    let (package, task) = answer.trim().split_once(' ')?;
    let duration = |seconds: &str| Duration::try_from_secs_f64(seconds.parse().ok()?).ok();
    Some([duration(package)?, duration(task)?])
}
