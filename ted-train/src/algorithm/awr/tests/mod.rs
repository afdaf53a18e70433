//! Advantage-weighted regression against numbers derived by hand, finite differences and a scalar reference.

mod improvement;
mod learner;
mod losses;
mod reference;
mod returns;

use crate::algorithm::Replay;
use crate::dataset::Dataset;
use crate::dataset::fixtures::{SHAPE, records};
use crate::nn::Backend;
use crate::nn::fixtures::numbers;
use crate::rng::Seed;

use super::{Awr, AwrConfig};

const ROWS: usize = 6;

/// Small networks, rates at which a few steps change everything visibly, and iterations of five updates.
fn config() -> AwrConfig {
    AwrConfig {
        critic_steps: 3,
        actor_steps: 2,
        batch: ROWS,
        hidden: vec![5, 4],
        critic_rate: 0.05,
        actor_rate: 0.01,
        value_scale: 10.0,
        output_scale: 0.3,
        ..AwrConfig::default()
    }
}

fn learner(seeds: &[u64], backend: Backend) -> Awr {
    let seeds: Vec<_> = seeds.iter().map(|&s| Seed::root(s)).collect();
    Awr::new(config(), SHAPE.observation, SHAPE.action, &seeds, backend)
}

/// Three episodes, of which the second ends in a terminal.
fn dataset() -> Dataset {
    Dataset::from_records("ted/x-v0", SHAPE, &records(&[6, 5, 7])).unwrap()
}

/// The dataset with labels of a lane: discounts of both kinds, and 0 after the terminal.
fn replay(dataset: &Dataset, lane: u64) -> Replay<'_> {
    let rewards = numbers(dataset.step_count(), &format!("rewards/{lane}"));
    let discount = |(i, &end): (usize, &bool)| match (end, i % 3) {
        (true, _) => 0.0,
        (_, 0) => 0.693,
        _ => 0.99,
    };
    let ends = dataset.terminations().iter().enumerate();
    Replay::new(dataset, rewards, ends.map(discount).collect())
}
