//! One action of a policy of the default size, by the device core, in floats and in integers.

use std::hint::black_box;
use std::time::Instant;

use ted_core::integer::{IntegerPolicy, IntegerScratch, MAX_FRACTION_BITS};
use ted_core::quantised::QuantisedPolicy;
use ted_core::{Normaliser, Policy, Scratch, ShapeError};

use crate::algorithm::iql::{Iql, IqlConfig};
use crate::nn::Backend;
use crate::quantise::{Calibration, QuantisedNetwork};
use crate::rng::Seed;

use super::iql::{ACTION, OBSERVATION};
use super::{BenchError, Timing, stop_if_asked};

/// Actions in one repetition.
const ACTIONS: u32 = 5_000;

/// Fraction bits at both ends: what they are changes no instruction.
const FRACTION_BITS: u8 = 12;
const _: () = assert!(FRACTION_BITS <= MAX_FRACTION_BITS);

pub(super) fn measure(repetitions: u32) -> Result<[Timing; 2], BenchError> {
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
    let normaliser = Normaliser::new(&shift, &scale)?;
    let observation = [0.3; OBSERVATION];
    let mlp = actors[0].view()?;
    let calibration = Calibration::new(normaliser, observation.to_vec())?;
    let integers = QuantisedNetwork::quantise(&mlp, &calibration, FRACTION_BITS, FRACTION_BITS)?;
    let integers = IntegerPolicy::new(FRACTION_BITS, FRACTION_BITS, integers.view()?)?;
    let integers = QuantisedPolicy::new(normaliser, integers)?;
    let policy = Policy::new(normaliser, mlp)?;

    let (mut scratch, mut integer_scratch) = (Scratch::new(), IntegerScratch::new());
    let (mut float_seconds, mut integer_seconds) = (Vec::new(), Vec::new());
    for _ in 0..repetitions {
        stop_if_asked()?;
        float_seconds.push(act(|action| {
            policy.act(black_box(&observation), &mut scratch, action)
        })?);
        integer_seconds.push(act(|action| {
            integers.act(black_box(&observation), &mut integer_scratch, action)
        })?);
    }
    Ok([
        Timing::new("Policy::act, 39-256-256-4", float_seconds),
        Timing::new("QuantisedPolicy::act, 39-256-256-4", integer_seconds),
    ])
}

/// Seconds that an action takes.
fn act(mut policy: impl FnMut(&mut [f32]) -> Result<(), ShapeError>) -> Result<f64, ShapeError> {
    let mut action = [0.0; ACTION];
    let begin = Instant::now();
    for _ in 0..ACTIONS {
        policy(&mut action)?;
        black_box(&action);
    }
    Ok(begin.elapsed().as_secs_f64() / f64::from(ACTIONS))
}
