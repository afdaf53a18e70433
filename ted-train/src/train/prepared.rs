//! A run on both sides of its last phase: with a reward and a discount for every transition it can learn a policy, and with
//! the policy it writes its artefact.

use firmware_sim::progress::Audience;

use crate::algorithm::{Conditions, Replay};
use crate::checkpoint::Checkpoint;
use crate::config::Config;
use crate::dataset::Dataset;
use crate::filter::Kept;
use crate::preferences::Teacher;
use crate::reward::RewardModel;
use crate::reward::episodes::Confidence;
use crate::rng::Seed;
use crate::run::{Clock, Phase, RunFolder, Spent};
use crate::ted::Discounted;

use super::offline::LearnedPolicy;
use super::rewards::{self, Rewards};
use super::work::Work;
use super::{Finished, FinishedRun, TrainError, check};

/// A run that has nothing left to do but to learn a policy.
pub struct Prepared<'a> {
    pub(super) dataset: &'a Dataset,
    pub(super) config: &'a Config,
    pub(super) folder: &'a RunFolder,
    /// The updates that were made and saved before.
    pub(super) saved: Option<Checkpoint>,
    rewards: Rewards,
    kept: Kept,
    discounted: Discounted,
    conditions: Option<Conditions>,
}

impl<'a> Prepared<'a> {
    /// Phases 1 to 3. A reward that the folder holds is not learned again; labels and discounts are always made again, which
    /// takes seconds.
    ///
    /// # Errors
    /// When [`check`] does, before anything is learned, and when a phase fails or is interrupted.
    pub fn new(
        dataset: &'a Dataset,
        config: &'a Config,
        folder: &'a RunFolder,
        teacher: &mut dyn Teacher,
        audience: Audience,
    ) -> Result<Self, TrainError> {
        check(dataset, config)?;
        let glitches = dataset.glitches().len();
        if glitches > 0 {
            audience.note(&format!(
                "glitches, single values of observations far from all others: {glitches}. What is usual there is learned from instead, and \
                 `ted check` names them"
            ));
        }

        // Phase 1 and 2: a reward for each transition.
        let work = Work {
            dataset,
            config,
            folder,
            audience,
        };
        let clock = Clock::start(folder, Phase::Reward);
        let rewards = rewards::rewards(work, teacher)?;

        // Phase 3: which transitions the policy is learned from, and a discount for each.
        let kept = config.filter.kept(dataset, &rewards.labels.returns_hat)?;
        let discounted = config.discount.apply(dataset, &rewards.labels)?;
        // A network's sums blur what a model of whole episodes says of them.
        let model = rewards.model.as_ref();
        let quality = model.and_then(RewardModel::quality);
        let trust = model.map_or(1.0, RewardModel::trust);
        let conditions = (config.algorithm)
            .conditions(
                dataset,
                &kept,
                quality.unwrap_or(&rewards.labels.returns_hat),
            )
            .map(|conditions| conditions.advanced(trust));
        if conditions.as_ref().is_some_and(Conditions::are_equal) {
            audience.note(
                "no episode is predicted to be better than the others, or algorithm.best is all of them: the policy imitates the \
                 average",
            );
        }
        let saved = folder.newest_checkpoint(config, audience);
        // Where updates were made before, all of this was done before too, and is only done again.
        if saved.is_none() && Spent::of(folder).is_none_or(|spent| spent.reward_of.is_none()) {
            clock.spent().write(folder)?;
        }
        Ok(Self {
            dataset,
            config,
            folder,
            saved,
            rewards,
            kept,
            discounted,
            conditions,
        })
    }

    /// How sure it is that its best episodes are better than the logs; none of a reward that cannot tell.
    #[must_use]
    pub fn confidence(&self) -> Option<&Confidence> {
        self.rewards.model.as_ref()?.confidence()
    }

    /// Writes the artefact of the policy that was learned, if a controller can fly it.
    ///
    /// # Errors
    /// When the controller could not run it, or the disk fails.
    pub fn finish(self, policy: LearnedPolicy) -> Result<Finished, TrainError> {
        let policy = match policy {
            LearnedPolicy::Network(policy) => policy,
            LearnedPolicy::Sequence(oppo) => return Ok(Finished::Sequence(oppo)),
        };
        let run = FinishedRun {
            config: self.config.clone(),
            policy,
            rewards: self.rewards,
            ted: self.discounted.lookup,
        };
        run.artefact(self.dataset)?.write(self.folder)?;
        Ok(Finished::Artefact(self.folder.artefact_path()))
    }

    /// The seed of everything random in the run.
    pub(super) fn root(&self) -> Seed {
        Seed::root(self.config.seed)
    }

    /// What the policy is learned from.
    pub(super) fn replay(&self) -> Replay<'a> {
        let Discounted {
            rewards, discounts, ..
        } = self.discounted.clone();
        Replay::new(self.dataset, rewards, discounts)
            .seen(self.config.observations)
            .keep(self.kept.clone())
            .conditioned(self.conditions.clone().unwrap_or_default())
            .answered(self.rewards.answers.clone())
    }

    /// Updates that it goes on from.
    pub(super) fn step(&self) -> u64 {
        self.saved.as_ref().map_or(0, |checkpoint| checkpoint.step)
    }

    /// Whether one learner can teach both: networks of the same shapes, and the same updates still to make. Dataset, rewards,
    /// discounts, seed and schedule may differ.
    pub(super) fn learns_like(&self, other: &Self) -> bool {
        let shapes = |of: &Self| (of.dataset.observation_dim(), of.dataset.action_dim());
        self.config.algorithm == other.config.algorithm
            && self.config.backend == other.config.backend
            && shapes(self) == shapes(other)
            && self.step() == other.step()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    use crate::config::Preset;
    use crate::dataset::{EpisodeRecord, Shape};
    use crate::preferences::ScriptedTeacher;
    use crate::reward::RewardConfig;
    use crate::run::DatasetReference;

    /// Twelve episodes of eight steps, all different.
    fn logs() -> Dataset {
        let shape = Shape {
            observation: 3,
            action: 2,
        };
        let steps = 8;
        let records = (0..12).map(|episode| {
            let wave = |i: usize| ((episode * 31 + i * 7) as f32).sin();
            EpisodeRecord {
                observations: (0..(steps + 1) * shape.observation).map(wave).collect(),
                actions: (0..steps * shape.action).map(|i| wave(i + 5)).collect(),
                rewards: (0..steps).map(|i| wave(i + 9).into()).collect(),
                terminations: vec![false; steps],
                truncations: (1..=steps).map(|step| step == steps).collect(),
                success: vec![false; steps],
                ..EpisodeRecord::default()
            }
        });
        let records: Vec<_> = records.collect();
        Dataset::from_records("ted/x-v0", shape, &records).unwrap()
    }

    #[test]
    fn a_policy_is_told_the_quality_of_episodes_and_not_the_sums_of_a_network_that_is_fitted_to_it()
    {
        let dataset = logs();
        let mut config = Preset::Steer.config();
        let RewardConfig::Episodes(episodes) = &mut config.reward else {
            panic!("a model of episodes");
        };
        (episodes.queries, episodes.held_out) = (2, 10);
        (episodes.clone.steps, episodes.network.steps) = (20, 2);
        let reference = DatasetReference {
            id: dataset.id().to_owned(),
            digest: dataset.digest().to_owned(),
            path: PathBuf::new(),
        };
        let temporary = tempfile::tempdir().unwrap();
        let folder = RunFolder::begin(temporary.path(), &config, &reference).unwrap();
        let mut teacher = ScriptedTeacher::truthful();
        let audience = Audience::Nobody;
        let prepared = Prepared::new(&dataset, &config, &folder, &mut teacher, audience).unwrap();

        let model = prepared.rewards.model.as_ref().unwrap();
        let of = |told: &[f32]| {
            let conditions = config.algorithm.conditions(&dataset, &prepared.kept, told);
            conditions.map(|conditions| conditions.advanced(model.trust()))
        };
        assert_eq!(prepared.conditions, of(model.quality().unwrap()));
        let sums = &prepared.rewards.labels.returns_hat;
        assert_ne!(prepared.conditions, of(sums));
    }
}
