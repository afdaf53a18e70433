//! The reward ensemble: its questions, and its answers from a file.

mod questions;
mod training;

use std::path::Path;

use firmware_sim::progress::Audience;

use crate::dataset::{Clip, Dataset, EpisodeRecord, Shape};
use crate::nn::fixtures::numbers;
use crate::nn::{Activation, Backend};
use crate::preferences::{Interview, LogEntry, PreferenceLog, Teacher};
use crate::reward::{InputScaling, Material};
use crate::rng::Seed;

use super::{Ensemble, OprlConfig, Trained, ask, train};

const SHAPE: Shape = Shape {
    observation: 3,
    action: 2,
};
const SEGMENT: u32 = 4;

/// Episodes of 9 steps whose true reward is the first channel of the observation.
fn dataset() -> Dataset {
    let records: Vec<_> = (0..8).map(episode).collect();
    Dataset::from_records("ted/x-v0", SHAPE, &records).unwrap()
}

fn episode(index: u64) -> EpisodeRecord {
    const STEPS: usize = 9;
    let draw = |name: &str, count| numbers(count, &format!("{index}/{name}"));
    let observations = draw("s", (STEPS + 1) * SHAPE.observation);
    EpisodeRecord {
        seed: None,
        rewards: observations
            .chunks(SHAPE.observation)
            .take(STEPS)
            .map(|row| row[0].into())
            .collect(),
        observations,
        actions: draw("a", STEPS * SHAPE.action),
        terminations: vec![false; STEPS],
        truncations: (1..=STEPS).map(|step| step == STEPS).collect(),
        success: vec![false; STEPS],
        infos: vec![],
    }
}

fn config() -> OprlConfig {
    OprlConfig {
        segment: Clip::Steps(SEGMENT),
        pool: 40,
        hidden: vec![8],
        output: Activation::Linear,
        scaling: InputScaling::Raw {},
        epochs: 30,
        learning_rate: 0.01,
        held_out: 200,
        ..OprlConfig::default()
    }
}

fn ensemble(config: &OprlConfig, dataset: &Dataset, backend: Backend) -> Ensemble {
    Ensemble::new(
        config,
        &dataset.observation_statistics(),
        SHAPE.action,
        Seed::root(1),
        backend,
    )
}

/// The whole procedure, and the log that it leaves at `path`.
fn learn(
    config: &OprlConfig,
    dataset: &Dataset,
    teacher: &mut dyn Teacher,
    path: &Path,
    seed: Seed,
    backend: Backend,
) -> (Trained, Vec<LogEntry>) {
    let log = PreferenceLog::open(path, dataset).unwrap();
    let mut interview = Interview::new(dataset, teacher, log);
    let on = Material {
        dataset,
        seed,
        backend,
        audience: Audience::Nobody,
    };
    let own = ask(config, on, &mut interview).unwrap();
    let trained = train(config, &own, on, &mut interview).unwrap();
    (trained, interview.entries().to_vec())
}
