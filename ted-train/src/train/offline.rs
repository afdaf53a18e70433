//! Phase 4: the offline learner's loop, with metrics, checkpoints and a clean stop, for one run or for many at once.
//!
//! Runs that learn alike are lanes of one learner and advance together. Each keeps a journal of its own; a run that diverges
//! or cannot write ends with its error, and its members go on computing beside the others, who do not notice.

use std::thread;

use firmware_sim::interrupt;

use crate::algorithm::oppo::Oppo;
use crate::algorithm::{Learner, Metrics, Policy, Replay};
use crate::checkpoint::{Checkpoint, ForeignCheckpoint};
use crate::nn::ExportedMlp;
use crate::run::RunError;

use super::journal::Journal;
use super::prepared::Prepared;
use super::{TrainError, Watch};

/// What the last phase of a run ends with.
pub enum LearnedPolicy {
    /// A policy that a controller flies.
    Network(NetworkPolicy),
    /// A policy that only this machine flies.
    Sequence(Box<Oppo>),
}

/// An actor, and the standardisation that its inputs need.
pub struct NetworkPolicy {
    pub(super) actor: ExportedMlp,
    pub(super) shift: Vec<f32>,
    pub(super) scale: Vec<f32>,
}

impl LearnedPolicy {
    pub(super) fn new(policy: Policy, replay: &Replay<'_>) -> Self {
        match policy {
            Policy::Sequence(oppo) => Self::Sequence(oppo),
            Policy::Mlp(actor) => Self::Network(NetworkPolicy {
                actor,
                shift: replay.shift().to_vec(),
                scale: replay.scale().to_vec(),
            }),
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
    let replays: Vec<_> = lanes.iter().map(|lane| lane.replay()).collect();
    let replays: Vec<_> = replays.iter().collect();
    let mut learner = match learner(lanes, &replays) {
        Ok(learner) => learner,
        Err(error) if lanes.len() == 1 => return vec![Err(RunError::from(error).into())],
        // It is told of the one that it belongs to.
        Err(_) => {
            let alone = lanes.iter().flat_map(|lane| together(&[lane], watch));
            return alone.collect();
        }
    };
    let algorithm = &lanes[0].config.algorithm;
    let count = lanes.len() as u64;
    let progress = watch.updates(algorithm.steps() * count);
    progress.skip(learner.step() * count);

    let ends: Vec<Result<(), TrainError>> = thread::scope(|scope| {
        let mut journals: Vec<_> = lanes
            .iter()
            .map(|lane| Journal::begin(scope, lane))
            .collect();
        while learner.step() < algorithm.steps() {
            let going_on = journals.iter().flatten().count();
            if going_on == 0 || interrupt::requested() {
                break;
            }
            let losses = learner.update(&replays);
            progress.advance(going_on as u64);
            let step = learner.step();
            if !journals.iter().flatten().any(|it| it.is_due(step)) {
                continue;
            }
            let updates = losses.read();
            progress.say(&headline(&updates[0]));
            let written = journals.into_iter().zip(updates).enumerate();
            journals = written
                .map(|(lane, (journal, row))| {
                    journal?.write(step, &row, |digest| learner.checkpoint(lane, digest))
                })
                .collect();
        }
        let (step, stopped) = (learner.step(), learner.step() < algorithm.steps());
        let ends = journals.into_iter().enumerate();
        ends.map(|(lane, journal)| match stopped {
            true => Err(journal?.stop(step, |digest| learner.checkpoint(lane, digest))),
            false => journal?.finish(),
        })
        .collect()
    });
    progress.finish();
    let learned = ends.into_iter().zip(learner.policies()).zip(&replays);
    learned
        .map(|((end, policy), replay)| end.map(|()| LearnedPolicy::new(policy, replay)))
        .collect()
}

/// A lane for each run, as far as it has come.
fn learner(
    lanes: &[&Prepared<'_>],
    replays: &[&Replay<'_>],
) -> Result<Box<dyn Learner>, ForeignCheckpoint> {
    let first = lanes[0];
    let roots: Vec<_> = lanes.iter().map(|lane| lane.root()).collect();
    let config = first.config;
    let mut learner = config.algorithm.learner(replays, &roots, config.backend);
    // Before the first update a fresh lane is what was saved, and one that was never saved is fresh.
    if first.step() > 0 {
        let saved: Vec<&Checkpoint> = lanes.iter().flat_map(|lane| &lane.saved).collect();
        learner.restore(&saved)?;
    }
    Ok(learner)
}

/// What a person who waits sees of an update: the mean value, or else the first of its losses.
fn headline(metrics: &Metrics) -> String {
    let losses = metrics.iter().find(|(name, _)| name.ends_with("_loss"));
    let first = metrics.get_key_value("value").or(losses);
    first.map_or(String::new(), |(name, number)| {
        let number = number.as_f64().unwrap_or(f64::NAN);
        format!("{} {number:.3}", name.replace('_', " "))
    })
}
