//! Phase 4: the offline learner's loop, with metrics, checkpoints and a clean stop, for one run or for many at once.
//!
//! Runs that learn alike are lanes of one learner and advance together. Each keeps a journal of its own; a run that diverges
//! or cannot write ends with its error, and its members go on computing beside the others, who do not notice.

use std::thread;

use firmware_sim::interrupt;
use rayon::prelude::*;
use serde::Serialize;

use crate::algorithm::AlgorithmConfig;
use crate::iql::{Batch, Iql, Replay, UpdateMetrics};
use crate::nn::ExportedMlp;
use crate::run::{Checkpoint, ForeignCheckpoint, RunError};

use super::journal::Journal;
use super::prepared::Prepared;
use super::{TrainError, Watch};

/// A row of `metrics.jsonl`.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct OfflineMetrics {
    #[serde(flatten)]
    update: UpdateMetrics,
    actor_rate: f64,
}

/// What the last phase of a run ends with.
pub struct LearnedPolicy {
    pub(super) actor: ExportedMlp,
    pub(super) shift: Vec<f32>,
    pub(super) scale: Vec<f32>,
}

impl LearnedPolicy {
    /// An actor, and the standardisation that its inputs need.
    pub(super) fn new(actor: ExportedMlp, replay: &Replay<'_>) -> Self {
        Self {
            actor,
            shift: replay.shift().to_vec(),
            scale: replay.scale().to_vec(),
        }
    }
}

/// Trains every run to its last step, going on from what it has saved, and says of each how it ended, in their order. What a
/// run learns does not depend on the others.
pub fn learn(lanes: &[&Prepared<'_>], watch: Watch<'_>) -> Vec<Result<LearnedPolicy, TrainError>> {
    let mut ends = Vec::new();
    let mut left: Vec<(usize, &Prepared<'_>)> = lanes.iter().copied().enumerate().collect();
    while let Some(&(_, first)) = left.first() {
        let (alike, others): (Vec<_>, Vec<_>) = left
            .into_iter()
            .partition(|(_, lane)| lane.learns_like(first));
        left = others;
        let (places, alike): (Vec<_>, Vec<_>) = alike.into_iter().unzip();
        ends.extend(places.into_iter().zip(together(&alike, watch)));
    }
    ends.sort_by_key(|&(place, _)| place);
    ends.into_iter().map(|(_, end)| end).collect()
}

/// The same for runs that learn alike.
fn together(lanes: &[&Prepared<'_>], watch: Watch<'_>) -> Vec<Result<LearnedPolicy, TrainError>> {
    let mut iql = match learner(lanes) {
        Ok(iql) => iql,
        Err(error) if lanes.len() == 1 => return vec![Err(RunError::from(error).into())],
        // It is told of the one that it belongs to.
        Err(_) => {
            let alone = lanes.iter().flat_map(|lane| together(&[lane], watch));
            return alone.collect();
        }
    };
    let AlgorithmConfig::Iql(settings) = &lanes[0].config.algorithm;
    let count = lanes.len() as u64;
    let progress = watch.updates(settings.steps * count);
    progress.skip(iql.step() * count);
    let replays: Vec<_> = lanes
        .iter()
        .map(|lane| (lane.replay(), lane.root().child("iql/batch")))
        .collect();

    let ends: Vec<Result<(), TrainError>> = thread::scope(|scope| {
        let mut journals: Vec<_> = lanes
            .iter()
            .map(|lane| Journal::begin(scope, lane))
            .collect();
        while iql.step() < settings.steps {
            let going_on = journals.iter().flatten().count();
            if going_on == 0 || interrupt::requested() {
                break;
            }
            let (at, size) = (iql.step(), settings.batch);
            let batches = replays.par_iter();
            let batches = batches.map(|(replay, stream)| replay.batch(*stream, at, size));
            let losses = iql.update(&Batch::of_lanes(batches.collect()));
            progress.advance(going_on as u64);
            let step = iql.step();
            if !journals.iter().flatten().any(|it| it.is_due(step)) {
                continue;
            }
            let updates = losses.read();
            progress.say(&format!("value {:.3}", updates[0].value));
            let written = journals.into_iter().zip(updates).enumerate();
            journals = written
                .map(|(lane, (journal, update))| {
                    let actor_rate = settings.actor_rate(step);
                    let row = OfflineMetrics { update, actor_rate };
                    journal?.write(step, &row, |digest| iql.checkpoint(lane, digest))
                })
                .collect();
        }
        let (step, stopped) = (iql.step(), iql.step() < settings.steps);
        let ends = journals.into_iter().enumerate();
        ends.map(|(lane, journal)| match stopped {
            true => Err(journal?.stop(step, |digest| iql.checkpoint(lane, digest))),
            false => journal?.finish(),
        })
        .collect()
    });
    progress.finish();
    let learned = ends.into_iter().zip(iql.actors()).zip(&replays);
    learned
        .map(|((end, actor), (replay, _))| end.map(|()| LearnedPolicy::new(actor, replay)))
        .collect()
}

/// A lane for each run, as far as it has come.
fn learner(lanes: &[&Prepared<'_>]) -> Result<Iql, ForeignCheckpoint> {
    let first = lanes[0];
    let AlgorithmConfig::Iql(settings) = &first.config.algorithm;
    let seeds: Vec<_> = lanes.iter().map(|lane| lane.root().child("iql")).collect();
    let mut iql = Iql::new(
        settings.clone(),
        first.dataset.observation_dim(),
        first.dataset.action_dim(),
        &seeds,
        first.config.backend,
    );
    // Before the first update a fresh lane is what was saved, and one that was never saved is fresh.
    if first.step() > 0 {
        let saved: Vec<&Checkpoint> = lanes.iter().flat_map(|lane| &lane.saved).collect();
        iql.restore(&saved)?;
    }
    Ok(iql)
}

impl OfflineMetrics {
    /// Refuses to go on with a network that has diverged.
    pub(super) fn finite(&self, step: u64) -> Result<(), TrainError> {
        let losses = [
            ("value", self.update.value_loss),
            ("policy", self.update.policy_loss),
            ("critic", self.update.critic_loss),
        ];
        match losses.iter().find(|(_, loss)| !loss.is_finite()) {
            Some(&(network, _)) => Err(TrainError::Diverged { network, step }),
            None => Ok(()),
        }
    }
}
