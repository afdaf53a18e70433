//! Small episodes for tests: plausible numbers, drawn from a fixed stream.

use super::{EpisodeRecord, InfoColumn, Shape};
use crate::rng::Seed;
use rand::RngExt;

/// Widths that no other size in the tests has.
pub(crate) const SHAPE: Shape = Shape {
    observation: 7,
    action: 4,
};

/// One episode of each length.
pub(crate) fn records(lengths: &[usize]) -> Vec<EpisodeRecord> {
    lengths
        .iter()
        .enumerate()
        .map(|(index, &steps)| record(index as u64, steps))
        .collect()
}

fn record(index: u64, steps: usize) -> EpisodeRecord {
    let mut rng = Seed::root(index).child("fixture").rng();
    let mut floats =
        |count: usize| -> Vec<f64> { (0..count).map(|_| rng.random_range(-1.0..1.0)).collect() };
    let narrow = |values: Vec<f64>| values.into_iter().map(|value| value as f32).collect();
    let last = |step: usize| step + 1 == steps;
    EpisodeRecord {
        seed: Some(1000 + index),
        observations: narrow(floats((steps + 1) * SHAPE.observation)),
        actions: narrow(floats(steps * SHAPE.action)),
        rewards: floats(steps),
        terminations: (0..steps).map(|step| last(step) && index == 1).collect(),
        truncations: (0..steps).map(|step| last(step) && index != 1).collect(),
        success: (0..steps)
            .map(|step| step >= 3 && index.is_multiple_of(2))
            .collect(),
        infos: vec![
            InfoColumn {
                name: "qpos".into(),
                width: 3,
                values: floats((steps + 1) * 3),
            },
            InfoColumn {
                name: "goal".into(),
                width: 1,
                values: floats(steps + 1),
            },
        ],
    }
}
