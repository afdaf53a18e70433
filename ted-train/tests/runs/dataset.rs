//! Small datasets on disk.

use std::path::{Path, PathBuf};

use firmware_sim::robot::Robot;
use rand::RngExt;
use ted_train::dataset::minari::{Behaviour, DatasetId, DatasetWriter, Origin};
use ted_train::dataset::{EpisodeRecord, Shape};
use ted_train::rng::Seed;

pub const SHAPE: Shape = Shape {
    observation: 7,
    action: 4,
};

/// Episodes of random numbers.
pub fn episodes(count: u64, steps: usize) -> Vec<EpisodeRecord> {
    (0..count).map(|index| episode(index, steps)).collect()
}

fn episode(index: u64, steps: usize) -> EpisodeRecord {
    let mut rng = Seed::root(index).child("episode").rng();
    let mut draw =
        |count: usize| -> Vec<f32> { (0..count).map(|_| rng.random_range(-1.0..1.0)).collect() };
    EpisodeRecord {
        seed: Some(index),
        observations: draw((steps + 1) * SHAPE.observation),
        actions: draw(steps * SHAPE.action),
        rewards: draw(steps).into_iter().map(f64::from).collect(),
        terminations: vec![false; steps],
        truncations: (1..=steps).map(|step| step == steps).collect(),
        success: vec![false; steps],
        infos: vec![],
    }
}

/// Writes `ted/<name>-v0` under `root`.
pub fn write(root: &Path, name: &str, records: &[EpisodeRecord]) -> PathBuf {
    let origin = Origin {
        task: "reach-v3".into(),
        recipe: "test".into(),
        seed: 0,
        episodes: records.len().try_into().unwrap(),
        goal: "none".into(),
        reward: "none".into(),
        engine: [].into(),
    };
    let id = DatasetId::new("ted", name, 0).unwrap();
    let robot = Robot::draft(SHAPE.observation, &[[-1.0, 1.0]; SHAPE.action]);
    let writer = DatasetWriter::open(root, id, origin, robot).unwrap();
    for (episode, record) in (0..).zip(records) {
        let behaviour = Behaviour {
            part: "test".into(),
            noise_std: 0.0,
            epsilon: 0.0,
            ..Behaviour::default()
        };
        writer.write(episode, behaviour, record).unwrap();
    }
    writer.finish().unwrap()
}
