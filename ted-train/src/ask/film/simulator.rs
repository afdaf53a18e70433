//! Films from the simulator: Meta-World draws the states that the logs recorded.

use std::path::{Path, PathBuf};

use firmware_sim::bridge::message::FaultCode;
use firmware_sim::bridge::{
    BridgeError, Environment, Look, PictureJob, State, Worker, environment,
};
use firmware_sim::worlds;

use super::{FilmSource, NoFilm};
use crate::dataset::{Dataset, minari};

/// Draws the states of a dataset in a worker of its own.
pub(super) struct Simulator {
    environment: Environment,
    worker: Option<Worker>,
    look: Look,
    dataset: PathBuf,
    task: String,
    seeds: Vec<Option<u64>>,
}

impl Simulator {
    /// Of a dataset in this folder, in pictures of this look. Nothing is installed for it, and nothing started yet.
    ///
    /// # Errors
    /// When it is no dataset of Meta-World, or the simulator is not installed.
    pub fn of(dataset: &Dataset, folder: &Path, look: Look) -> Result<Self, NoFilm> {
        let drawn = |task: &&str| worlds::single(task).is_ok_and(|task| task.kind().draws());
        let task = dataset.task().filter(drawn);
        let task = task.ok_or_else(|| {
            NoFilm("no simulator knows these logs, so only numbers can be drawn".into())
        })?;
        let environment = environment::find().map_err(|error| NoFilm(error.to_string()))?;
        let environment = environment.ok_or_else(|| {
            NoFilm(
                "the simulator is not installed on this machine; a command that needs it installs it, such as \
                 ted collect --task reach-v3 --episodes 1"
                    .into(),
            )
        })?;
        Ok(Self {
            environment,
            worker: None,
            look,
            dataset: folder.to_path_buf(),
            task: task.to_owned(),
            seeds: dataset.episodes().iter().map(|it| it.seed).collect(),
        })
    }

    /// Everything that a picture depends on beside episode and step.
    pub fn key(&self, dataset: &Dataset) -> String {
        let Look {
            width,
            height,
            quality,
        } = self.look;
        let (drawn, data) = (environment::drawing_digest(), dataset.digest());
        let short = |digest: &str| digest.chars().take(8).collect::<String>();
        format!(
            "{width}x{height}-q{quality}-{}-{}",
            short(&drawn),
            short(data)
        )
    }

    /// A picture of each of these states of the episode of a seed, on the worker that is there, or on a fresh one.
    ///
    /// # Errors
    /// When they cannot be made, also on another worker.
    pub fn draw(&mut self, seed: u64, states: Vec<State>) -> Result<Vec<Vec<u8>>, NoFilm> {
        let job = PictureJob {
            task: self.task.clone(),
            seed,
            look: self.look,
            states,
        };
        let drawn = match self.render(&job) {
            Err(error) if error.is_worker_failure() => self.render(&job),
            drawn => drawn,
        };
        drawn.map_err(why)
    }

    fn render(&mut self, job: &PictureJob) -> Result<Vec<Vec<u8>>, BridgeError> {
        let mut worker = match self.worker.take() {
            Some(worker) => worker,
            None => Worker::spawn(&self.environment)?,
        };
        let drawn = worker.render(job);
        if !drawn.as_ref().is_err_and(BridgeError::is_worker_failure) {
            self.worker = Some(worker);
        }
        Ok(drawn?.jpegs)
    }
}

impl FilmSource for Simulator {
    fn prepare(&mut self) -> Result<(), NoFilm> {
        self.draw(0, Vec::new()).map(drop)
    }

    fn stills(&mut self, episode: u32, steps: &[u32]) -> Result<Vec<Vec<u8>>, NoFilm> {
        let seed = self.seeds.get(episode as usize).copied().flatten();
        let states =
            minari::states(&self.dataset, episode).map_err(|error| NoFilm(error.to_string()))?;
        let unknown = || NoFilm("the logs do not hold the simulator's states".into());
        let (seed, states) = seed.zip(states).ok_or_else(unknown)?;
        let chosen = steps.iter().map(|&step| states.get(step as usize).cloned());
        let chosen = chosen.collect::<Option<_>>().ok_or_else(unknown)?;
        self.draw(seed, chosen)
    }
}

fn why(error: BridgeError) -> NoFilm {
    match error {
        BridgeError::Refused {
            code: FaultCode::NoPictures,
            message,
            ..
        } => NoFilm(message),
        error => NoFilm(format!("failed to {error}")),
    }
}
