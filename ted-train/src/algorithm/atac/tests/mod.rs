//! Adversarially trained actor critic against numbers derived by hand, finite differences and a scalar reference.

mod gaussian;
mod learner;
mod losses;
mod reference;
mod support;

use crate::algorithm::fixtures::{ACTION, OBSERVATION, ROWS};
use crate::nn::Backend;
use crate::rng::Seed;

use super::{Atac, AtacConfig};

/// Small networks, and rates at which a few steps change everything visibly. The warm start ends after three updates.
fn config() -> AtacConfig {
    AtacConfig {
        steps: 80,
        warm_start: 3,
        batch: ROWS,
        hidden: vec![5, 4],
        fast_rate: 0.01,
        slow_rate: 0.005,
        target_rate: 0.1,
        // Above some of the matrices' norms and below others.
        norm_limit: 1.5,
        ..AtacConfig::default()
    }
}

fn learner(config: &AtacConfig, seeds: &[u64], backend: Backend) -> Atac {
    let seeds: Vec<_> = seeds.iter().map(|&s| Seed::root(s)).collect();
    Atac::new(config.clone(), OBSERVATION, ACTION, &seeds, backend)
}
