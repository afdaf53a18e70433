//! OPPO: its losses by hand and by differences, its networks' gradients, its update, and what it learns.

mod gradients;
mod learning;
mod losses;
mod pilot;

use crate::dataset::{Dataset, EpisodeRecord, Shape};
use crate::nn::fixtures::numbers;

use super::OppoConfig;

const SHAPE: Shape = Shape {
    observation: 2,
    action: 1,
};
const SEGMENT: u32 = 4;

/// Episodes of 6 steps of somebody who goes up in every second one and down in the others; the reward is the action, the
/// observation tells nothing.
fn dataset() -> Dataset {
    let records: Vec<_> = (0..16).map(episode).collect();
    Dataset::from_records("ted/x-v0", SHAPE, &records).unwrap()
}

fn episode(index: u64) -> EpisodeRecord {
    const STEPS: usize = 6;
    let draw = |name: &str, count| numbers(count, &format!("{index}/{name}"));
    let way = if index.is_multiple_of(2) { 0.5 } else { -0.5 };
    let actions: Vec<f32> = draw("a", STEPS).iter().map(|a| way + 0.2 * a).collect();
    EpisodeRecord {
        seed: None,
        rewards: actions.iter().map(|&a| a.into()).collect(),
        observations: draw("s", (STEPS + 1) * SHAPE.observation),
        actions,
        terminations: vec![false; STEPS],
        truncations: (1..=STEPS).map(|step| step == STEPS).collect(),
        success: vec![false; STEPS],
        infos: vec![],
    }
}

fn config() -> OppoConfig {
    OppoConfig {
        segment: SEGMENT,
        width: 8,
        layers: 2,
        heads: 2,
        latent: 3,
        batch: 8,
        steps: 30,
        warmup: 10,
        ..OppoConfig::default()
    }
}
