//! One simulator process: started, greeted, asked one thing at a time, and never left behind.

use std::os::unix::process::CommandExt;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use super::environment::Environment;
use super::episode::{Episode, EpisodeJob};
use super::error::{BridgeError, Nonsense};
use super::frame::PROTOCOL_VERSION;
use super::link::{Link, LinkError};
use super::message::{self, FaultCode, MessageError, Move, Shape, Step, kind};
use super::picture::{PictureJob, Pictures, State};
use crate::last_words::{LastWords, Listener};

/// How long a worker may take for anything but a whole episode. Importing the simulator from a cold disk is the slowest.
const PATIENCE: Duration = Duration::from_secs(120);
/// What a step of a whole episode adds to that.
const PATIENCE_PER_STEP: Duration = Duration::from_millis(500);

/// How long a process may take to end after it closed its pipes.
const WAIT_FOR_END: Duration = Duration::from_secs(1);

const STARTING: &str = "start the simulator";

/// A simulator process with at most one open task.
///
/// Dropping it kills the process. After an error for which [`BridgeError::is_worker_failure`] holds the process is gone,
/// and every further request fails.
#[derive(Debug)]
pub struct Worker {
    child: Child,
    link: Link,
    stderr: Listener,
    patience: Duration,
    sequence: u32,
    versions: String,
    task: Option<(String, Shape)>,
    payload: Vec<u8>,
}

impl Worker {
    /// Starts a worker and waits until it has imported its simulator.
    ///
    /// # Errors
    /// When it does not start, speaks another protocol, or cannot import the simulator.
    pub fn spawn(environment: &Environment) -> Result<Self, BridgeError> {
        Self::spawn_patiently(environment, PATIENCE)
    }

    /// Starts a worker that is given up when a request takes longer than `patience`.
    ///
    /// # Errors
    /// As [`Worker::spawn`].
    pub fn spawn_patiently(
        environment: &Environment,
        patience: Duration,
    ) -> Result<Self, BridgeError> {
        let spawn_error = |source| BridgeError::Spawn {
            python: environment.python().to_owned(),
            source,
        };
        let mut child = command(environment).spawn().map_err(spawn_error)?;
        let (Some(stdin), Some(stdout), Some(stderr)) =
            (child.stdin.take(), child.stdout.take(), child.stderr.take())
        else {
            return Err(spawn_error(std::io::ErrorKind::BrokenPipe.into()));
        };
        let mut worker = Self {
            child,
            link: Link::new(stdin, stdout),
            stderr: Listener::new(stderr),
            patience,
            sequence: 0,
            versions: String::new(),
            task: None,
            payload: Vec::new(),
        };
        worker.greet(environment)?;
        Ok(worker)
    }

    /// The versions of Python, the simulator and its libraries, as `name=version` separated by spaces.
    #[must_use]
    pub fn versions(&self) -> &str {
        &self.versions
    }

    /// The process id, for messages and tests.
    #[must_use]
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// The sizes of the open task.
    #[must_use]
    pub fn shape(&self) -> Option<Shape> {
        self.task.as_ref().map(|(_, shape)| *shape)
    }

    /// Opens a task; opening the one that is open costs nothing.
    ///
    /// # Errors
    /// When there is no such task or the worker fails.
    pub fn open(&mut self, task: &str) -> Result<Shape, BridgeError> {
        if let Some((open, shape)) = &self.task
            && open == task
        {
            return Ok(*shape);
        }
        self.task = None;
        let during = "open a task";
        let patience = self.patience;
        let opened = self.ask(
            during,
            kind::OPEN,
            &message::open(task),
            patience,
            message::parse_opened,
        )?;
        self.task = Some((task.to_owned(), opened));
        Ok(opened)
    }

    /// Starts the episode of a seed in a slot: the first observation, and the goal that was drawn.
    ///
    /// # Errors
    /// When no task is open or the worker fails.
    pub fn reset(&mut self, slot: u16, seed: u64) -> Result<(Vec<f32>, Vec<f64>), BridgeError> {
        let shape = self.shape().ok_or(BridgeError::NoTask)?;
        let patience = self.patience;
        self.ask(
            "start an episode",
            kind::RESET,
            &message::reset(slot, seed),
            patience,
            |payload| message::parse_resetted(payload, &shape),
        )
    }

    /// Applies one action to the episode in slot 0.
    ///
    /// # Errors
    /// As [`Worker::step_all`].
    pub fn step(&mut self, action: &[f32]) -> Result<Step, BridgeError> {
        let action = action.to_vec();
        let mut steps = self.step_all(&[Move { slot: 0, action }])?;
        Ok(steps.remove(0))
    }

    /// Applies an action to each of several episodes; what came of them, as many and in the same order.
    ///
    /// # Errors
    /// When an action has the wrong length, no episode is running in a slot, or the worker fails.
    pub fn step_all(&mut self, moves: &[Move]) -> Result<Vec<Step>, BridgeError> {
        let shape = self.shape().ok_or(BridgeError::NoTask)?;
        if let Some(odd) = moves.iter().find(|one| one.action.len() != shape.action) {
            return Err(BridgeError::ActionLength {
                expected: shape.action,
                actual: odd.action.len(),
            });
        }
        let mut payload = std::mem::take(&mut self.payload);
        message::step(moves, &mut payload);
        let patience = self.patience;
        let stepped = self.ask("make a step", kind::STEP, &payload, patience, |payload| {
            message::parse_stepped(payload, &shape, moves.len())
        });
        self.payload = payload;
        stepped
    }

    /// Plays a whole episode of the scripted policy, opening its task first if need be.
    ///
    /// # Errors
    /// When there is no such task, it has fewer steps, or the worker fails.
    pub fn collect(&mut self, job: &EpisodeJob) -> Result<Episode, BridgeError> {
        let shape = self.open(&job.task)?;
        let patience = self.patience + PATIENCE_PER_STEP * job.steps;
        self.ask(
            "play an episode",
            kind::COLLECT,
            &message::collect(job),
            patience,
            |payload| message::parse_collected(payload, &shape),
        )
    }

    /// Draws recorded states of a task, opening it first if need be. What is played before and after has the same bits.
    ///
    /// # Errors
    /// When there is no such task, no picture can be made on this machine, or the worker fails.
    pub fn render(&mut self, job: &PictureJob) -> Result<Pictures, BridgeError> {
        self.open(&job.task)?;
        let states = job.states.len();
        let patience = self.patience + PATIENCE_PER_STEP * u32::try_from(states).unwrap_or(0);
        self.ask(
            "draw a picture",
            kind::RENDER,
            &message::render(job),
            patience,
            |payload| message::parse_rendered(payload, states),
        )
    }

    /// The state of the episode in a slot, as far as it can be seen: something to draw.
    ///
    /// # Errors
    /// When no episode is running there, or the worker fails.
    pub fn state(&mut self, slot: u16) -> Result<State, BridgeError> {
        let shape = self.shape().ok_or(BridgeError::NoTask)?;
        let patience = self.patience;
        self.ask(
            "say a state",
            kind::STATE,
            &message::state(slot),
            patience,
            |payload| message::parse_stated(payload, &shape),
        )
    }

    fn greet(&mut self, environment: &Environment) -> Result<(), BridgeError> {
        // A worker that is gone already cannot be written to; what it sent before it went is worth more than that.
        let greeted = self.link.greet(PROTOCOL_VERSION);
        let actual = match self.link.receive_greeting(self.patience) {
            Ok(version) => version,
            Err(LinkError::Frame(_)) => {
                return Err(BridgeError::NotAWorker {
                    last_words: self.end(),
                });
            }
            Err(error) => return Err(self.failure(STARTING, self.patience, error)),
        };
        if actual != PROTOCOL_VERSION {
            return Err(BridgeError::ProtocolVersion {
                expected: PROTOCOL_VERSION,
                actual,
                remedy: environment.remedy(),
            });
        }
        greeted.map_err(|error| self.failure(STARTING, self.patience, error))?;
        match self.reply(
            STARTING,
            kind::READY,
            0,
            self.patience,
            message::parse_ready,
        ) {
            Ok(versions) => self.versions = versions,
            Err(BridgeError::Refused {
                code: FaultCode::CannotStart,
                message,
                ..
            }) => {
                return Err(BridgeError::CannotStart {
                    message,
                    remedy: environment.remedy(),
                    last_words: self.end(),
                });
            }
            Err(error) => return Err(error),
        }
        Ok(())
    }

    /// Sends a request and parses its reply.
    fn ask<T>(
        &mut self,
        during: &'static str,
        request: u16,
        payload: &[u8],
        patience: Duration,
        parse: impl FnOnce(&[u8]) -> Result<T, MessageError>,
    ) -> Result<T, BridgeError> {
        self.sequence = self.sequence.wrapping_add(1);
        if let Err(error) = self.link.send(request, self.sequence, payload) {
            return Err(self.failure(during, patience, error));
        }
        self.reply(
            during,
            request | kind::READY,
            self.sequence,
            patience,
            parse,
        )
    }

    fn reply<T>(
        &mut self,
        during: &'static str,
        expected: u16,
        sequence: u32,
        patience: Duration,
        parse: impl FnOnce(&[u8]) -> Result<T, MessageError>,
    ) -> Result<T, BridgeError> {
        let nonsense = match self.link.receive(patience) {
            Err(error) => return Err(self.failure(during, patience, error)),
            Ok((header, _)) if header.sequence != sequence => Nonsense::Sequence {
                expected: sequence,
                actual: header.sequence,
            },
            Ok((header, payload)) if header.kind == kind::FAULT => {
                match message::parse_fault(payload) {
                    Ok((code, message)) => {
                        return Err(BridgeError::Refused {
                            during,
                            code,
                            message,
                        });
                    }
                    Err(error) => error.into(),
                }
            }
            Ok((header, payload)) if header.kind == expected => match parse(payload) {
                Ok(value) => return Ok(value),
                Err(error) => error.into(),
            },
            Ok((header, _)) => Nonsense::Kind {
                expected,
                actual: header.kind,
            },
        };
        Err(BridgeError::Garbled {
            during,
            source: nonsense,
            last_words: self.end(),
        })
    }

    /// Turns a broken link into an error with the worker's last words; the worker is dead afterwards.
    fn failure(
        &mut self,
        during: &'static str,
        patience: Duration,
        error: LinkError,
    ) -> BridgeError {
        let status = match error {
            LinkError::Closed => self.own_end(),
            _ => None,
        };
        let last_words = self.end();
        match error {
            LinkError::Closed => BridgeError::Died {
                during,
                status: status.map_or("it closed its pipes".to_owned(), |s| s.to_string()),
                last_words,
            },
            LinkError::Silent => BridgeError::Silent {
                during,
                seconds: patience.as_secs(),
                last_words,
            },
            LinkError::Frame(source) => BridgeError::Garbled {
                during,
                source: source.into(),
                last_words,
            },
            LinkError::Interrupted => BridgeError::Interrupted,
        }
    }

    /// How the process ended by itself, if it does: its pipes close a little before it can be reaped.
    fn own_end(&mut self) -> Option<ExitStatus> {
        let deadline = Instant::now() + WAIT_FOR_END;
        loop {
            match self.child.try_wait() {
                Ok(None) if Instant::now() < deadline => thread::sleep(Duration::from_millis(5)),
                status => return status.ok().flatten(),
            }
        }
    }

    /// Kills and reaps the process, and returns what it said last.
    fn end(&mut self) -> LastWords {
        // Both fail only for a process that is gone already.
        self.child.kill().ok();
        self.child.wait().ok();
        self.task = None;
        self.stderr.words()
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.child.kill().ok();
        self.child.wait().ok();
    }
}

fn command(environment: &Environment) -> Command {
    let mut command = environment.command();
    settings(&mut command)
        .current_dir(environment.scratch())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        // Out of the terminal's foreground group: Ctrl-C is the parent's business alone.
        .process_group(0);
    command
}

/// What every process that simulates has in its environment.
pub(super) fn settings(command: &mut Command) -> &mut Command {
    // One process per core is the parallelism; threads inside would only disturb it, and with it the bits.
    command
        .envs(
            ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"].map(|name| (name, "1")),
        )
        .env("MUJOCO_GL", "disable")
}
