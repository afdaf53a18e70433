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
    batch_of([ROWS, OBSERVATION, ACTION], lanes, step)
}

/// The same with so many rows, observations and actions.
fn batch_of([rows, observation, action]: [usize; 3], lanes: &[u64], step: u64) -> Batch {
    let of_lane = |lane: &u64| {
        let draw = |name: &str, count| numbers(count, &format!("{lane}/{step}/{name}"));
        // Discounts of both kinds, and terminals.
        let discounts = [0.99, 0.693, 0.99, 0.0, 0.693, 0.99].into_iter().cycle();
        Batch {
            observations: draw("s", rows * observation),
            next_observations: draw("s'", rows * observation),
            actions: draw("a", rows * action),
            rewards: draw("r", rows),
            discounts: discounts.take(rows).collect(),
            transitions: (0..rows as u32).collect(),
        }
    };
    Batch::of_lanes(lanes.iter().map(of_lane).collect())
}
