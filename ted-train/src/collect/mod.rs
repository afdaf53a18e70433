//! Collects Meta-World datasets: scripted policies made worse by a recipe, recorded as Minari datasets.
//!
//! Episode `i` is a function of (task, recipe, root seed, `i`) and each episode is on the disk before it counts. So neither the
//! number of workers nor a kill half-way shows in the bytes, and running again fills only what is missing.

mod error;
mod recipe;
mod record;
mod report;
mod source;

pub use error::CollectError;
pub use recipe::Recipe;
pub use report::{CollectReport, PartReport};
pub use source::{BridgeSource, EpisodeSource};

use crate::dataset::Shape;
use crate::dataset::minari::{self, Behaviour, DatasetId, DatasetWriter, EpisodeNote, Origin};
use crate::rng::Seed;
use firmware_sim::bridge::{Environment, EpisodeJob};
use firmware_sim::interrupt;
use firmware_sim::progress::Audience;
use firmware_sim::tasks;
use std::ops::ControlFlow;
use std::path::PathBuf;

/// Steps of a Meta-World episode. Collection never stops at success, as the paper's score asks for.
pub const EPISODE_STEPS: u32 = 500;
/// The namespace of collected datasets.
pub const NAMESPACE: &str = "ted";
/// Widths of a Meta-World observation and action.
const SHAPE: Shape = Shape {
    observation: 39,
    action: 4,
};
const GOAL_POLICY: &str = "visible, drawn per episode from its seed";
const REWARD_VERSION: &str = "v2";

/// What to collect, and where to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CollectConfig {
    /// The task, such as `drawer-open-v3`.
    pub task: String,
    /// How the actions are made.
    pub recipe: Recipe,
    /// Number of episodes; none for the recipe's own.
    pub episodes: Option<u32>,
    /// Root seed.
    pub seed: u64,
    /// Simulator processes at a time; does not change the result.
    pub workers: usize,
    /// The folder that holds the namespace, as `MINARI_DATASETS_PATH` does.
    pub root: PathBuf,
}

impl CollectConfig {
    /// Number of episodes.
    #[must_use]
    pub fn episode_count(&self) -> u32 {
        self.episodes.unwrap_or(self.recipe.default_episodes())
    }

    /// The dataset's id, such as `ted/drawer-open-v3-paper-s0-v0`. A number of episodes that is not the recipe's own is part of
    /// the name (`-n20`), because it moves the border between the recipe's parts.
    pub fn dataset_id(&self) -> Result<DatasetId, CollectError> {
        let task = tasks::single(&self.task)?;
        let episodes = match self.episode_count() {
            0 => return Err(CollectError::NoEpisodes),
            count if count == self.recipe.default_episodes() => String::new(),
            count => format!("-n{count}"),
        };
        let name = format!("{task}-{}{episodes}-s{}", self.recipe, self.seed);
        Ok(DatasetId::new(NAMESPACE, &name, 0)?)
    }

    /// The dataset's folder.
    pub fn folder(&self) -> Result<PathBuf, CollectError> {
        Ok(self.dataset_id()?.folder(&self.root))
    }

    fn behaviour(&self, episode: u32) -> Behaviour {
        self.recipe.behaviour(episode, self.episode_count())
    }

    fn episode_seed(&self, episode: u32) -> u64 {
        Seed::root(self.seed)
            .child(&format!("collect/{}/{}/{episode}", self.task, self.recipe))
            .value()
    }

    fn job(&self, episode: u32) -> EpisodeJob {
        let Behaviour {
            noise_std, epsilon, ..
        } = self.behaviour(episode);
        EpisodeJob {
            task: self.task.clone(),
            behaviour: firmware_sim::bridge::Behaviour { noise_std, epsilon },
            seed: self.episode_seed(episode),
            steps: EPISODE_STEPS,
        }
    }

    fn origin(&self, versions: &str) -> Origin {
        // The interpreter computes nothing that reaches the data, so it is no part of the engine.
        let engine = versions
            .split_whitespace()
            .filter_map(|part| part.split_once('='))
            .filter(|(package, _)| *package != "python")
            .map(|(package, version)| (package.to_string(), version.to_string()))
            .collect();
        Origin {
            task: self.task.clone(),
            recipe: self.recipe.to_string(),
            seed: self.seed,
            episodes: self.episode_count(),
            goal: GOAL_POLICY.into(),
            reward: REWARD_VERSION.into(),
            engine,
        }
    }
}

/// Collects what is missing of a dataset on Meta-World itself.
pub fn run(
    config: &CollectConfig,
    environment: &Environment,
    audience: Audience,
) -> Result<CollectReport, CollectError> {
    run_on(
        config,
        &mut BridgeSource::new(environment, config.workers),
        audience,
    )
}

/// The report of a dataset that is complete and undamaged; none when there is something to collect. Needs no simulator.
pub fn finished(config: &CollectConfig) -> Result<Option<CollectReport>, CollectError> {
    let id = config.dataset_id()?;
    let folder = id.folder(&config.root);
    let Some(origin) = minari::finished_origin(&folder) else {
        return Ok(None);
    };
    if (Origin {
        engine: origin.engine.clone(),
        ..config.origin("")
    }) != origin
    {
        return Ok(None);
    }
    let notes: Option<Vec<_>> = (0..config.episode_count())
        .map(|i| minari::kept_episode(&folder, i, config.episode_seed(i), &config.behaviour(i)))
        .collect();
    Ok(notes.map(|notes| CollectReport::new(id.to_string(), folder, 0, notes)))
}

/// Collects what is missing of a dataset from any source of episodes.
pub fn run_on(
    config: &CollectConfig,
    source: &mut dyn EpisodeSource,
    audience: Audience,
) -> Result<CollectReport, CollectError> {
    if let Some(report) = finished(config)? {
        return Ok(report);
    }
    let id = config.dataset_id()?;
    let total = config.episode_count();
    let origin = config.origin(&source.versions()?);
    let writer = DatasetWriter::open(&config.root, id.clone(), origin, SHAPE)?;

    let mut notes: Vec<Option<EpisodeNote>> = (0..total)
        .map(|i| writer.kept(i, config.episode_seed(i), &config.behaviour(i)))
        .collect();
    let missing: Vec<u32> = (0..total)
        .filter(|&i| notes[i as usize].is_none())
        .collect();
    let jobs: Vec<_> = missing.iter().map(|&episode| config.job(episode)).collect();

    let progress = audience.start(
        &format!("collect {}", config.task),
        u64::from(total),
        "episodes",
    );
    progress.skip(u64::from(total) - missing.len() as u64);
    let mut failure = None;
    let outcome = source.run(&jobs, &mut |index, episode| {
        let episode_index = missing[index];
        let record = record::from_bridge(jobs[index].seed, episode);
        match writer.write(episode_index, config.behaviour(episode_index), &record) {
            Ok(note) => {
                notes[episode_index as usize] = Some(note);
                progress.advance(1);
                ControlFlow::Continue(())
            }
            Err(error) => {
                failure = Some(error);
                ControlFlow::Break(())
            }
        }
    });
    progress.finish();
    if let Some(error) = failure {
        return Err(error.into());
    }
    let done = notes.iter().flatten().count();
    match outcome {
        Err(firmware_sim::bridge::BridgeError::Interrupted) => {
            return Err(CollectError::Interrupted { done, total });
        }
        Err(error) => return Err(error.into()),
        Ok(()) if done < notes.len() && interrupt::requested() => {
            return Err(CollectError::Interrupted { done, total });
        }
        Ok(()) => {}
    }
    let folder = writer.finish()?;
    let notes = notes.into_iter().flatten().collect();
    Ok(CollectReport::new(
        id.to_string(),
        folder,
        missing.len(),
        notes,
    ))
}

#[cfg(test)]
mod tests;
