//! One update of the learner on a synthetic dataset of the paper's size, drawing its batch included.

use std::time::Instant;

use firmware_sim::progress::Audience;
use rand::RngExt;
use rayon::ThreadPool;
use rayon::prelude::*;

use crate::algorithm::Replay;
use crate::algorithm::iql::{Iql, IqlConfig};
use crate::dataset::{Dataset, DatasetError, EpisodeRecord, Shape};
use crate::nn::Backend;
use crate::rng::Seed;

use super::{BenchConfig, BenchError, Timing, stop_if_asked};

pub(super) const OBSERVATION: usize = 39;
pub(super) const ACTION: usize = 4;
const EPISODES: usize = 1000;
const STEPS: usize = 500;
/// Updates before the clock starts.
const WARM_UP: u32 = 20;

/// Independent learners, each on threads of its own.
pub struct Learners {
    learners: Vec<(Iql, ThreadPool)>,
}

impl Learners {
    /// Fresh ones with the default hyper-parameters.
    ///
    /// # Errors
    /// When the operating system has no more threads.
    pub fn new(backend: Backend, learners: u64, threads: usize) -> Result<Self, BenchError> {
        let learner = |seed| {
            let seeds = [Seed::root(seed)];
            let iql = Iql::new(IqlConfig::default(), OBSERVATION, ACTION, &seeds, backend);
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.map(|pool| (iql, pool)).map_err(BenchError::Threads)
        };
        let learners = (0..learners).map(learner).collect::<Result<_, _>>()?;
        Ok(Self { learners })
    }

    /// Makes `updates` updates of every learner, all learners at once, and returns the seconds that took.
    pub fn run(&mut self, replay: &Replay<'_>, updates: u32) -> f64 {
        let begin = Instant::now();
        std::thread::scope(|scope| {
            for (iql, pool) in &mut self.learners {
                scope.spawn(|| pool.install(|| learn(iql, replay, updates)));
            }
        });
        begin.elapsed().as_secs_f64()
    }
}

fn learn(iql: &mut Iql, replay: &Replay<'_>, updates: u32) {
    let (stream, size) = (Seed::root(0).child("bench"), iql.config().batch);
    for _ in 0..updates {
        let losses = iql.update(&replay.batch(stream, iql.step(), size));
        std::hint::black_box(&losses);
    }
}

/// What is compared: name, backend, learners, threads of each.
const CASES: [(&str, Backend, u64, usize); 6] = [
    ("fused, 2 threads", Backend::Fused, 1, 2),
    ("fused, 1 thread", Backend::Fused, 1, 1),
    ("fused, one of two learners", Backend::Fused, 2, 1),
    ("burn flex, 2 threads", Backend::Flex, 1, 2),
    ("burn flex, one of two learners", Backend::Flex, 2, 1),
    ("burn ndarray", Backend::Ndarray, 1, 1),
];

/// Times of an update of one learner, the fast engine with two threads first.
pub(super) fn measure(config: &BenchConfig, audience: Audience) -> Result<Vec<Timing>, BenchError> {
    let dataset = synthetic()?;
    let replay = replay(&dataset);
    let mut cases = Vec::new();
    for (name, backend, count, threads) in CASES {
        let mut learners = Learners::new(backend, count, threads)?;
        learners.run(&replay, WARM_UP);
        cases.push((name, count, learners, Vec::new()));
    }
    let total = u64::from(config.repetitions) * u64::from(config.updates) * CASES.len() as u64;
    let progress = audience.start("update", total, "updates");
    for _ in 0..config.repetitions {
        for (_, count, learners, seconds) in &mut cases {
            stop_if_asked()?;
            let updates = config.updates.max(1);
            seconds.push(learners.run(&replay, updates) / (f64::from(updates) * *count as f64));
            progress.advance(u64::from(config.updates));
        }
    }
    progress.finish();
    let timing = |(name, _, _, seconds)| Timing::new(&format!("IQL update, {name}"), seconds);
    Ok(cases.into_iter().map(timing).collect())
}

/// What the learners train on, at a constant discount.
#[must_use]
pub fn replay(dataset: &Dataset) -> Replay<'_> {
    let rows = dataset.step_count();
    Replay::new(dataset, dataset.rewards_true().to_vec(), vec![0.99; rows])
}

/// 500,000 random transitions in 1,000 episodes.
///
/// # Errors
/// Never, unless the dataset's own rules changed.
pub fn synthetic() -> Result<Dataset, DatasetError> {
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
    let records: Vec<_> = (0..EPISODES).into_par_iter().map(record).collect();
    let shape = Shape {
        observation: OBSERVATION,
        action: ACTION,
    };
    Dataset::from_records("ted/synthetic-v0", shape, &records)
}
