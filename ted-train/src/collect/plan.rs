//! What a configuration comes to: which episodes, under which name. Whoever has a plan has numbers that make sense.

use super::recipe::Played;
use super::{CollectConfig, CollectError, NAMESPACE, Recipe};
use crate::dataset::minari::{Behaviour, DatasetId, Origin};
use crate::rng::Seed;
use firmware_sim::bridge::EpisodeJob;
use firmware_sim::robot::Robot;
use firmware_sim::worlds::{self, Collection, Task};
use std::path::PathBuf;

const VISIBLE: &str = "visible, drawn per episode from its seed";
const HIDDEN: &str = "hidden, one of two that take turns";

/// The episodes of a dataset.
pub(super) struct Plan<'a> {
    config: &'a CollectConfig,
    pub task: Task,
    pub collection: Collection,
    pub id: DatasetId,
    /// How many episodes.
    pub total: u32,
    /// How many of them are good.
    good: u32,
    /// The recipe, with the number of good episodes (`paper-good20`) if it is not the recipe's own.
    recipe: String,
}

impl<'a> Plan<'a> {
    pub fn new(config: &'a CollectConfig) -> Result<Self, CollectError> {
        let task = worlds::single(&config.task)?;
        let none = || CollectError::NoScript { task: task.name() };
        let collection = task.collection().ok_or_else(none)?;
        let (recipe, total) = (config.recipe, config.episode_count());
        if total == 0 {
            return Err(CollectError::NoEpisodes);
        }
        if collection.push.is_none() && matches!(recipe, Recipe::Biased | Recipe::Drift) {
            return Err(CollectError::NoPush {
                task: task.name(),
                recipe,
            });
        }
        let own = recipe.default_good(total);
        let (good, recipe) = match (config.good, own) {
            (Some(_), None) => return Err(CollectError::NoGoodPart { recipe }),
            (Some(good), _) if good > total => {
                return Err(CollectError::TooManyGood { good, total });
            }
            (Some(good), Some(own)) if good != own => (good, format!("{recipe}-good{good}")),
            _ => (own.unwrap_or_default(), recipe.to_string()),
        };
        let episodes = match total == config.recipe.default_episodes() {
            true => String::new(),
            false => format!("-n{total}"),
        };
        let name = format!("{}-{recipe}{episodes}-s{}", task.name(), config.seed);
        Ok(Self {
            config,
            task,
            collection,
            id: DatasetId::new(NAMESPACE, &name, 0)?,
            total,
            good,
            recipe,
        })
    }

    /// The robot that is recorded.
    pub fn robot(&self) -> Robot {
        self.task.robot()
    }

    pub fn folder(&self) -> PathBuf {
        self.id.folder(&self.config.root)
    }

    /// Whatever the number of good episodes, an episode has its luck: a log with fewer differs in the others alone. Whoever
    /// rewards a scene of two intentions, it is the same episode.
    pub fn seed(&self, episode: u32) -> u64 {
        let CollectConfig { task, recipe, .. } = self.config;
        let task = self.collection.scene.unwrap_or(task);
        Seed::root(self.config.seed)
            .child(&format!("collect/{task}/{recipe}/{episode}"))
            .value()
    }

    /// Two intentions take turns.
    fn played(&self, episode: u32) -> Played {
        let push = self.collection.push.unwrap_or_default();
        let played = self.config.recipe.played(episode, self.good, push);
        match self.collection.scene {
            None => played,
            Some(_) => played.after((episode % 2) as u8),
        }
    }

    /// What is noted beside an episode about its behaviour.
    pub fn behaviour(&self, episode: u32) -> Behaviour {
        self.played(episode).note()
    }

    pub fn job(&self, episode: u32) -> EpisodeJob {
        EpisodeJob {
            task: self.config.task.clone(),
            behaviour: self.played(episode).behaviour,
            seed: self.seed(episode),
            steps: self.collection.steps,
        }
    }

    pub fn origin(&self, versions: &str) -> Origin {
        // The interpreter computes nothing that reaches the data, so it is no part of the engine.
        let engine = versions
            .split_whitespace()
            .filter_map(|part| part.split_once('='))
            .filter(|(package, _)| *package != "python")
            .map(|(package, version)| (package.to_string(), version.to_string()))
            .collect();
        Origin {
            task: self.config.task.clone(),
            recipe: self.recipe.clone(),
            seed: self.config.seed,
            episodes: self.total,
            goal: if self.collection.scene.is_some() {
                HIDDEN
            } else {
                VISIBLE
            }
            .into(),
            reward: self.collection.reward.into(),
            engine,
        }
    }
}
