//! One action of a policy of the default size, by the device core.

use std::hint::black_box;
use std::time::Instant;

use ted_core::{Normaliser, Policy, Scratch};

use crate::iql::{Iql, IqlConfig};
use crate::nn::Backend;
use crate::rng::Seed;

use super::iql::{ACTION, OBSERVATION};
use super::{BenchError, Timing, stop_if_asked};

/// Actions in one repetition.
const ACTIONS: u32 = 5_000;

pub(super) fn measure(repetitions: u32) -> Result<Timing, BenchError> {
    let seeds = [Seed::root(0)];
    let iql = Iql::new(
        IqlConfig::default(),
        OBSERVATION,
        ACTION,
        &seeds,
        Backend::Flex,
    );
    let actors = iql.actors();
    let (shift, scale) = ([0.1; OBSERVATION], [1.1; OBSERVATION]);
    let policy = Policy::new(Normaliser::new(&shift, &scale)?, actors[0].view()?)?;
    let mut scratch = Scratch::new();
    let (observation, mut action) = ([0.3; OBSERVATION], [0.0; ACTION]);
    let mut seconds = Vec::new();
    for _ in 0..repetitions {
        stop_if_asked()?;
        let begin = Instant::now();
        for _ in 0..ACTIONS {
            policy.act(black_box(&observation), &mut scratch, &mut action)?;
            black_box(&action);
        }
        seconds.push(begin.elapsed().as_secs_f64() / f64::from(ACTIONS));
    }
    Ok(Timing::new("Policy::act, 39-256-256-4", seconds))
}
