//! Several workers that play a list of episodes, handed out as they get free.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread;

use super::environment::Environment;
use super::episode::{Episode, EpisodeJob};
use super::error::BridgeError;
use super::worker::Worker;
use crate::interrupt;

/// Workers for whole episodes. They are started when there is work for them, and stay for the next list.
#[derive(Debug)]
pub struct Pool {
    environment: Environment,
    workers: Vec<Option<Worker>>,
}

impl Pool {
    /// A pool of at most `workers` processes, at least one.
    #[must_use]
    pub fn new(environment: &Environment, workers: usize) -> Self {
        Self {
            environment: environment.clone(),
            workers: (0..workers.max(1)).map(|_| None).collect(),
        }
    }

    /// Plays all jobs and gives each episode to `on_episode` on the calling thread, with its place in the list, in the
    /// order in which they finish. `Break` stops the rest, which is no error.
    ///
    /// An episode whose worker fails is played again from its seed on a fresh one, once.
    ///
    /// # Errors
    /// The first job that failed for good, or [`BridgeError::Interrupted`]. Episodes that were delivered stay delivered.
    pub fn run(
        &mut self,
        jobs: &[EpisodeJob],
        mut on_episode: impl FnMut(usize, Episode) -> ControlFlow<()>,
    ) -> Result<(), BridgeError> {
        let next = AtomicUsize::new(0);
        let stop = AtomicBool::new(false);
        let environment = &self.environment;
        // Bounded, so that a slow receiver holds the workers back instead of filling the memory.
        let (results, finished) = sync_channel(self.workers.len());
        thread::scope(|scope| {
            for worker in self.workers.iter_mut().take(jobs.len()) {
                let results = results.clone();
                let line = Line {
                    jobs,
                    next: &next,
                    stop: &stop,
                };
                scope.spawn(move || line.work(environment, worker, &results));
            }
            drop(results);
            let mut outcome = Ok(());
            for (index, result) in finished {
                if stop.load(Ordering::Relaxed) {
                    continue;
                }
                let go_on = match result {
                    Ok(episode) => on_episode(index, episode).is_continue(),
                    Err(error) => {
                        outcome = Err(error);
                        false
                    }
                };
                stop.store(!go_on, Ordering::Relaxed);
            }
            if outcome.is_ok()
                && interrupt::requested()
                && next.load(Ordering::Relaxed) < jobs.len()
            {
                outcome = Err(BridgeError::Interrupted);
            }
            outcome
        })
    }
}

/// The list of jobs that the threads of a pool work off together.
struct Line<'a> {
    jobs: &'a [EpisodeJob],
    next: &'a AtomicUsize,
    stop: &'a AtomicBool,
}

impl Line<'_> {
    fn work(
        &self,
        environment: &Environment,
        worker: &mut Option<Worker>,
        results: &SyncSender<(usize, Result<Episode, BridgeError>)>,
    ) {
        while !self.stop.load(Ordering::Relaxed) && !interrupt::requested() {
            let index = self.next.fetch_add(1, Ordering::Relaxed);
            let Some(job) = self.jobs.get(index) else {
                return;
            };
            let result = play(environment, worker, job);
            let failed = result.is_err();
            if results.send((index, result)).is_err() || failed {
                return;
            }
        }
    }
}

/// Plays one job, on a fresh worker if the present one fails.
fn play(
    environment: &Environment,
    worker: &mut Option<Worker>,
    job: &EpisodeJob,
) -> Result<Episode, BridgeError> {
    let first = match attempt(environment, worker, job) {
        Err(error) if error.is_worker_failure() => error,
        result => return result,
    };
    match attempt(environment, worker, job) {
        // What the first worker said may explain the second one's trouble; a refusal says all by itself.
        Err(second)
            if !matches!(
                second,
                BridgeError::Interrupted | BridgeError::Refused { .. }
            ) =>
        {
            Err(BridgeError::FailedTwice {
                task: job.task.clone(),
                seed: job.seed,
                first: Box::new(first),
                second: Box::new(second),
            })
        }
        result => result,
    }
}

fn attempt(
    environment: &Environment,
    worker: &mut Option<Worker>,
    job: &EpisodeJob,
) -> Result<Episode, BridgeError> {
    let mut ready = match worker.take() {
        Some(ready) => ready,
        None => Worker::spawn(environment)?,
    };
    let episode = ready.collect(job)?;
    *worker = Some(ready);
    Ok(episode)
}
