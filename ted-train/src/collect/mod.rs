//! Collects datasets of Meta-World, and of the toy: scripted policies made worse by a recipe, recorded as Minari datasets.
//!
//! Episode `i` is a function of (task, recipe, root seed, `i`) and each episode is on the disk before it counts. So neither the
//! number of workers nor a kill half-way shows in the bytes, and running again fills only what is missing.

mod error;
mod plan;
mod recipe;
mod record;
mod report;
mod source;
mod toy;

pub use error::CollectError;
pub use recipe::Recipe;
pub use report::{CollectReport, PartReport};
pub use source::{BridgeSource, EpisodeSource};
pub use toy::ToySource;

use crate::dataset::Shape;
use crate::dataset::minari::{self, DatasetId, DatasetWriter, EpisodeNote, Origin, Room};
use crate::need;
use firmware_sim::bridge::{Engine, Environment};
use firmware_sim::disk::Disk;
use firmware_sim::interrupt;
use firmware_sim::progress::Audience;
use firmware_sim::worlds::World;
use plan::Plan;
use std::ops::ControlFlow;
use std::path::PathBuf;

/// The namespace of collected datasets.
pub const NAMESPACE: &str = "ted";

/// What to collect, and where to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CollectConfig {
    /// The task, such as `drawer-open-v3`.
    pub task: String,
    /// How the actions are made.
    pub recipe: Recipe,
    /// Number of episodes; none for the recipe's own.
    pub episodes: Option<u32>,
    /// Number of good episodes, those with noise alone; none for the recipe's own.
    pub good: Option<u32>,
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
    /// the name (`-n20`), because it moves the border between the recipe's parts, and so is one of good episodes (`-good20`).
    ///
    /// # Errors
    /// When there is no such task, or a number of episodes makes no sense.
    pub fn dataset_id(&self) -> Result<DatasetId, CollectError> {
        Ok(Plan::new(self)?.id)
    }

    /// The dataset's folder.
    ///
    /// # Errors
    /// As [`CollectConfig::dataset_id`].
    pub fn folder(&self) -> Result<PathBuf, CollectError> {
        Ok(Plan::new(self)?.folder())
    }
}

/// Collects what is missing of a dataset where its task is played: the toy in this process, another one in its simulator, on this engine
/// if there is a choice, which is installed first if need be.
pub fn run_anywhere(
    config: &CollectConfig,
    engine: Engine,
    audience: Audience,
) -> Result<CollectReport, CollectError> {
    if let Some(report) = finished(config)? {
        return Ok(report);
    }
    check_room(config)?;
    if let Some(mut toy) = ToySource::of(config) {
        return run_on(config, &mut toy, audience);
    }
    // A plan is of a task that has a scripted policy. That is known before anything is installed.
    let task = Plan::new(config)?.task;
    let world = World::Listed(task).ready(engine, audience)?;
    let none = CollectError::NoScript { task: task.name() };
    run(config, world.simulator().ok_or(none)?, audience)
}

/// Collects what is missing of a dataset in its simulator.
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
    let plan = Plan::new(config)?;
    let folder = plan.folder();
    let Some(origin) = minari::finished_origin(&folder) else {
        return Ok(None);
    };
    if (Origin {
        engine: origin.engine.clone(),
        ..plan.origin("")
    }) != origin
    {
        return Ok(None);
    }
    let notes: Option<Vec<_>> = (0..plan.total)
        .map(|i| minari::kept_episode(&folder, i, plan.seed(i), &plan.behaviour(i)))
        .collect();
    Ok(notes.map(|notes| CollectReport::new(plan.id.to_string(), folder, 0, notes)))
}

/// Collects what is missing of a dataset from any source of episodes.
pub fn run_on(
    config: &CollectConfig,
    source: &mut dyn EpisodeSource,
    audience: Audience,
) -> Result<CollectReport, CollectError> {
    run_on_disk(Disk::REAL, config, source, audience)
}

fn run_on_disk(
    disk: Disk,
    config: &CollectConfig,
    source: &mut dyn EpisodeSource,
    audience: Audience,
) -> Result<CollectReport, CollectError> {
    if let Some(report) = finished(config)? {
        return Ok(report);
    }
    let plan = Plan::new(config)?;
    make_sure_of_room(disk, &plan)?;
    let total = plan.total;
    let origin = plan.origin(&source.versions()?);
    let writer = DatasetWriter::open(&config.root, plan.id.clone(), origin, plan.robot())?;

    let mut notes: Vec<Option<EpisodeNote>> = (0..total)
        .map(|i| writer.kept(i, plan.seed(i), &plan.behaviour(i)))
        .collect();
    let missing: Vec<u32> = (0..total)
        .filter(|&i| notes[i as usize].is_none())
        .collect();
    let jobs: Vec<_> = missing.iter().map(|&episode| plan.job(episode)).collect();

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
        match writer.write(episode_index, plan.behaviour(episode_index), &record) {
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
        plan.id.to_string(),
        folder,
        missing.len(),
        notes,
    ))
}

/// Whether there is memory and disk for what is missing of a dataset, before a simulator is installed for it.
///
/// # Errors
/// When there is not, or the numbers make no sense.
pub fn check_room(config: &CollectConfig) -> Result<(), CollectError> {
    make_sure_of_room(Disk::REAL, &Plan::new(config)?)
}

/// Refuses episodes that there is no memory or no disk for.
fn make_sure_of_room(disk: Disk, plan: &Plan<'_>) -> Result<(), CollectError> {
    /// What is kept in memory of an episode: its job and its note, with their texts.
    const KEPT: f64 = 1024.0;
    need::check_count("--episodes", plan.total.into(), KEPT)?;
    let steps = plan.job(0).steps;
    let room = Room {
        shape: Shape::of(&plan.robot()),
        infos: plan.collection.infos,
    };
    let missing = plan.total - minari::begun_episodes(&plan.folder()).min(plan.total);
    let steps = u64::from(steps) * u64::from(missing);
    let what = format!("recording {missing} episodes");
    Ok(room.require(disk, &plan.folder(), &what, missing.into(), steps)?)
}

#[cfg(test)]
mod tests;
