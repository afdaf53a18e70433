//! The Preference Transformer: its gradients, its labels, what it learns, and that it goes on where it was stopped.

mod gradients;
mod labels;
mod learning;

use crate::dataset::{Dataset, EpisodeRecord, Shape};
use crate::nn::fixtures::numbers;
use crate::nn::{Backend, WarmupCosine};
use crate::reward::InputScaling;
use crate::rng::Seed;

use super::{PtConfig, RewardHead, RewardTransformer};

const SHAPE: Shape = Shape {
    observation: 3,
    action: 2,
};
const SEGMENT: u32 = 4;
const HEADS: [RewardHead; 2] = [RewardHead::PerStep, RewardHead::WeightedSum];

/// Episodes of 9 steps whose true reward is the first channel of the observation.
fn dataset() -> Dataset {
    let records: Vec<_> = (0..12).map(episode).collect();
    Dataset::from_records("ted/x-v0", SHAPE, &records).unwrap()
}

fn episode(index: u64) -> EpisodeRecord {
    const STEPS: usize = 9;
    let draw = |name: &str, count| numbers(count, &format!("{index}/{name}"));
    let observations = draw("s", (STEPS + 1) * SHAPE.observation);
    let rows = observations.chunks(SHAPE.observation).take(STEPS);
    EpisodeRecord {
        seed: None,
        rewards: rows.map(|row| row[0].into()).collect(),
        observations,
        actions: draw("a", STEPS * SHAPE.action),
        terminations: vec![false; STEPS],
        truncations: (1..=STEPS).map(|step| step == STEPS).collect(),
        success: vec![false; STEPS],
        infos: vec![],
    }
}

fn config(head: RewardHead) -> PtConfig {
    PtConfig {
        segment: SEGMENT,
        width: 8,
        heads: 2,
        head,
        scaling: InputScaling::Raw {},
        steps: 60,
        rate: WarmupCosine {
            start: 1e-3,
            peak: 1e-2,
            end: 1e-3,
            warmup: 0.1,
        },
        held_out: 200,
        ..PtConfig::default()
    }
}

fn transformer(config: &PtConfig, dataset: &Dataset, backend: Backend) -> RewardTransformer {
    let statistics = dataset.observation_statistics();
    RewardTransformer::new(config, &statistics, SHAPE.action, Seed::root(1), backend)
}
