//! Phase 4: the offline learner's loop, with metrics, checkpoints and a clean stop.

use std::thread;

use firmware_sim::interrupt;
use serde::Serialize;

use crate::algorithm::AlgorithmConfig;
use crate::config::Config;
use crate::dataset::Dataset;
use crate::iql::{Iql, Replay, UpdateMetrics};
use crate::nn::ExportedMlp;
use crate::rng::Seed;
use crate::run::{EventWriter, MetricsLog, RunError, RunFolder, Saver};

use super::{TrainError, Watch};

/// A row of `metrics.jsonl`.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct OfflineMetrics {
    #[serde(flatten)]
    update: UpdateMetrics,
    actor_rate: f64,
}

pub(super) struct LearnedPolicy {
    pub actor: ExportedMlp,
    pub shift: Vec<f32>,
    pub scale: Vec<f32>,
}

impl LearnedPolicy {
    /// The actor of the first lane, and the standardisation that its inputs need.
    pub(super) fn new(iql: &Iql, replay: &Replay<'_>) -> Self {
        Self {
            actor: iql.actors().swap_remove(0),
            shift: replay.shift().to_vec(),
            scale: replay.scale().to_vec(),
        }
    }
}

/// Trains to the last step, going on from the newest checkpoint in the folder.
pub(super) fn learn(
    dataset: &Dataset,
    config: &Config,
    folder: &RunFolder,
    rewards: Vec<f32>,
    discounts: Vec<f32>,
    root: Seed,
    watch: Watch<'_>,
) -> Result<LearnedPolicy, TrainError> {
    let AlgorithmConfig::Iql(settings) = &config.algorithm;
    let replay = Replay::new(dataset, rewards, discounts);
    let digest = config.digest();
    let seeds = [root.child("iql")];
    let mut iql = Iql::new(
        settings.clone(),
        dataset.observation_dim(),
        dataset.action_dim(),
        &seeds,
        config.backend,
    );
    if let Some(checkpoint) = folder.newest_checkpoint(config, watch.audience()) {
        iql.restore(&[&checkpoint]).map_err(RunError::from)?;
    }
    let mut metrics = MetricsLog::resume(&folder.file("metrics.jsonl"), iql.step())?;
    let mut events = EventWriter::create(folder.path(), iql.step())?;
    let progress = watch.updates(settings.steps);
    progress.skip(iql.step());

    let stream = root.child("iql/batch");
    thread::scope(|scope| {
        let saver = Saver::start(scope, folder, &metrics)?;
        while iql.step() < settings.steps {
            if interrupt::requested() {
                // Whether it was handed over is seen at the end.
                let _ = saver.save(iql.checkpoint(0, digest));
                saver.finish()?;
                return Err(TrainError::Interrupted { step: iql.step() });
            }
            let losses = iql.update(&replay.batch(stream, iql.step(), settings.batch));
            progress.advance(1);
            let step = iql.step();
            let last = step == settings.steps;
            if step.is_multiple_of(config.schedule.log_every) || last {
                let update = losses.read().swap_remove(0);
                finite(&update, step)?;
                let row = OfflineMetrics {
                    update,
                    actor_rate: settings.actor_rate(step),
                };
                let row = metrics.push("iql", step, &row)?;
                events.push("iql", step, &row)?;
                progress.say(&format!("value {:.3}", update.value));
            }
            let due = step.is_multiple_of(config.schedule.checkpoint_every) || last;
            if due && !saver.save(iql.checkpoint(0, digest)) {
                break;
            }
        }
        Ok(saver.finish()?)
    })?;
    progress.finish();
    Ok(LearnedPolicy::new(&iql, &replay))
}

fn finite(update: &UpdateMetrics, step: u64) -> Result<(), TrainError> {
    let losses = [
        ("value", update.value_loss),
        ("policy", update.policy_loss),
        ("critic", update.critic_loss),
    ];
    match losses.iter().find(|(_, loss)| !loss.is_finite()) {
        Some(&(network, _)) => Err(TrainError::Diverged { network, step }),
        None => Ok(()),
    }
}
