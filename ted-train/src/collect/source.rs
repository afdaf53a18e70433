//! Where episodes come from: the bridge, or a stand-in that needs no Python.

use firmware_sim::bridge::{BridgeError, Environment, Episode, EpisodeJob, Pool, Worker};
use std::ops::ControlFlow;

/// Receives an episode with its place in the list of jobs; `Break` stops the rest.
pub type OnEpisode<'a> = &'a mut dyn FnMut(usize, Episode) -> ControlFlow<()>;

/// Something that plays episodes. The same job must always give the same episode.
pub trait EpisodeSource {
    /// What the episodes depend on beside the job, as `name=version` separated by spaces.
    fn versions(&mut self) -> Result<String, BridgeError>;

    /// Plays the jobs in any order and hands each episode over as it is ready.
    fn run(&mut self, jobs: &[EpisodeJob], on_episode: OnEpisode) -> Result<(), BridgeError>;
}

/// Meta-World, on several processes.
#[derive(Debug)]
pub struct BridgeSource<'a> {
    environment: &'a Environment,
    pool: Pool,
}

impl<'a> BridgeSource<'a> {
    /// A source that runs at most this many simulators at a time.
    #[must_use]
    pub fn new(environment: &'a Environment, workers: usize) -> Self {
        Self {
            environment,
            pool: Pool::new(environment, workers),
        }
    }
}

impl EpisodeSource for BridgeSource<'_> {
    fn versions(&mut self) -> Result<String, BridgeError> {
        Worker::spawn(self.environment).map(|worker| worker.versions().to_string())
    }

    fn run(&mut self, jobs: &[EpisodeJob], on_episode: OnEpisode) -> Result<(), BridgeError> {
        self.pool.run(jobs, on_episode)
    }
}
