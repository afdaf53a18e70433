//! One update of the learner on a synthetic dataset of the paper's size, drawing its batch included.

use std::time::Instant;

use firmware_sim::progress::Audience;
use rand::RngExt;

use crate::dataset::{Dataset, DatasetError, EpisodeRecord, Shape};
use crate::iql::{Iql, IqlConfig, Replay};
use crate::nn::Backend;
use crate::rng::Seed;

use super::{BenchConfig, BenchError, Timing, stop_if_asked};

pub(super) const OBSERVATION: usize = 39;
pub(super) const ACTION: usize = 4;
const EPISODES: usize = 1000;
const STEPS: usize = 500;
/// Updates before the clock starts.
const WARM_UP: u32 = 20;

/// Times of an update on flex and on ndarray.
pub(super) fn measure(config: &BenchConfig, audience: Audience) -> Result<[Timing; 2], BenchError> {
    let dataset = synthetic()?;
    let rows = dataset.step_count();
    let replay = Replay::new(&dataset, dataset.rewards_true().to_vec(), vec![0.99; rows]);
    let mut learners = [Backend::Flex, Backend::Ndarray].map(|backend| {
        let seeds = [Seed::root(0)];
        Iql::new(IqlConfig::default(), OBSERVATION, ACTION, &seeds, backend)
    });
    for learner in &mut learners {
        repetition(learner, &replay, WARM_UP);
    }
    let mut seconds = [Vec::new(), Vec::new()];
    let total = u64::from(config.repetitions) * u64::from(config.updates) * 2;
    let progress = audience.start("update", total, "updates");
    for _ in 0..config.repetitions {
        for (learner, seconds) in learners.iter_mut().zip(&mut seconds) {
            stop_if_asked()?;
            seconds.push(repetition(learner, &replay, config.updates));
            progress.advance(u64::from(config.updates));
        }
    }
    progress.finish();
    let [flex, ndarray] = seconds;
    Ok([
        Timing::new("IQL update, burn flex", flex),
        Timing::new("IQL update, burn ndarray", ndarray),
    ])
}

/// Seconds of one of `updates` updates.
fn repetition(learner: &mut Iql, replay: &Replay<'_>, updates: u32) -> f64 {
    let stream = Seed::root(0).child("bench");
    let size = learner.config().batch;
    let begin = Instant::now();
    for _ in 0..updates {
        let losses = learner.update(&replay.batch(stream, learner.step(), size));
        std::hint::black_box(&losses);
    }
    begin.elapsed().as_secs_f64() / f64::from(updates.max(1))
}

/// 500,000 random transitions in 1,000 episodes.
fn synthetic() -> Result<Dataset, DatasetError> {
    let stream = Seed::root(0).child("bench/dataset");
    let record = |episode: usize| {
        let mut rng = stream.rng_at(episode as u64);
        let mut draw = |count: usize| -> Vec<f32> {
            (0..count).map(|_| rng.random_range(-1.0..1.0)).collect()
        };
        EpisodeRecord {
            seed: None,
            observations: draw((STEPS + 1) * OBSERVATION),
            actions: draw(STEPS * ACTION),
            rewards: draw(STEPS).into_iter().map(f64::from).collect(),
            terminations: vec![false; STEPS],
            truncations: (1..=STEPS).map(|step| step == STEPS).collect(),
            success: vec![false; STEPS],
            infos: Vec::new(),
        }
    };
    let records: Vec<_> = (0..EPISODES).map(record).collect();
    let shape = Shape {
        observation: OBSERVATION,
        action: ACTION,
    };
    Dataset::from_records("ted/synthetic-v0", shape, &records)
}
