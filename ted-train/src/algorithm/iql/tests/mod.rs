//! Implicit Q-learning against numbers derived by hand, finite differences and a scalar reference.

mod learner;
mod losses;
mod reference;

use crate::nn::Backend;
use crate::rng::Seed;

use super::{Iql, IqlConfig};
use crate::algorithm::fixtures::{ACTION, OBSERVATION, ROWS};

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
