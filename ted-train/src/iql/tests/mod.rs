//! Implicit Q-learning against numbers derived by hand, finite differences and a scalar reference.

mod learner;
mod losses;
mod reference;
mod replay;

use crate::nn::Backend;
use crate::nn::fixtures::numbers;
use crate::rng::Seed;

use super::{Batch, Iql, IqlConfig};

const OBSERVATION: usize = 3;
const ACTION: usize = 2;
const ROWS: usize = 6;

/// Small networks, and rates at which a few steps change everything visibly.
fn config() -> IqlConfig {
    IqlConfig {
        steps: 80,
        batch: ROWS,
        hidden: vec![5, 4],
        learning_rate: 0.01,
        target_rate: 0.1,
        ..IqlConfig::default()
    }
}

fn learner(config: &IqlConfig, seeds: &[u64], backend: Backend) -> Iql {
    let seeds: Vec<_> = seeds.iter().map(|&s| Seed::root(s)).collect();
    Iql::new(config.clone(), OBSERVATION, ACTION, &seeds, backend)
}

/// A batch for each lane, the same wherever the lane stands.
fn batch(lanes: &[u64], step: u64) -> Batch {
    let mut batch = Batch::default();
    for lane in lanes {
        let draw = |name: &str, count| numbers(count, &format!("{lane}/{step}/{name}"));
        batch.observations.extend(draw("s", ROWS * OBSERVATION));
        batch
            .next_observations
            .extend(draw("s'", ROWS * OBSERVATION));
        batch.actions.extend(draw("a", ROWS * ACTION));
        batch.rewards.extend(draw("r", ROWS));
        // Discounts of both kinds, and terminals.
        let discounts = [0.99, 0.693, 0.99, 0.0, 0.693, 0.99];
        batch.discounts.extend(discounts);
    }
    batch
}
