//! First that all engines compute the same, then how long each takes, in turn.

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

use crate::engines::Engine;
use crate::network::{ACTION, Network};

/// Observations that are shown one after the other; one turn of an engine is an action for each.
const OBSERVATIONS: usize = 64;

/// Actions before a turn is timed: the engines before it have taken the caches.
const WARM_ACTIONS: usize = 8;

/// Rounds that are not counted.
const WARM_ROUNDS: usize = 20;

type Engines<'n> = [Box<dyn Engine + 'n>];

/// The largest error of each engine, against 64-bit arithmetic.
///
/// # Errors
/// When one is above what the engine may have, or the policy is too dull to tell.
pub fn check(network: &Network, engines: &mut Engines<'_>) -> Result<Vec<f64>, Box<dyn Error>> {
    let observations = network.observations(OBSERVATIONS);
    let mut largest = vec![0.0_f64; engines.len()];
    let mut span = 0.0_f64;
    for observation in &observations {
        let exact = network.exact(observation);
        span = exact.iter().fold(span, |span, y| span.max(y.abs()));
        for (engine, largest) in engines.iter_mut().zip(&mut largest) {
            let mut action = [f32::NAN; ACTION];
            engine.act(observation, &mut action)?;
            for (computed, exact) in action.iter().zip(&exact) {
                let error = (f64::from(*computed) - exact).abs();
                if error.is_nan() || error > engine.tolerance() {
                    return Err(format!(
                        "{} computed {computed} where {exact} is right, so nothing was timed",
                        engine.name()
                    )
                    .into());
                }
                *largest = largest.max(error);
            }
        }
    }
    if span < 0.5 {
        return Err(format!("no action is above {span}: the policy is too dull to compare").into());
    }
    Ok(largest)
}

/// Nanoseconds for one action, `[engine][round]`.
///
/// # Errors
/// When an engine fails.
pub fn time(
    network: &Network,
    engines: &mut Engines<'_>,
    rounds: usize,
) -> Result<Vec<Vec<f64>>, Box<dyn Error>> {
    let observations = network.observations(OBSERVATIONS);
    let mut nanoseconds = vec![Vec::with_capacity(rounds); engines.len()];
    let count = engines.len();
    for round in 0..WARM_ROUNDS + rounds {
        for turn in 0..count {
            // Another first one each round, so that none always follows the same one.
            let index = (turn + round) % count;
            let engine = &mut engines[index];
            let mut action = [0.0; ACTION];
            for observation in &observations[..WARM_ACTIONS] {
                engine.act(black_box(observation), &mut action)?;
            }
            // Short, so that another program that takes the processor spoils few rounds.
            let begin = Instant::now();
            for observation in &observations {
                engine.act(black_box(observation), &mut action)?;
                black_box(&action);
            }
            let elapsed = begin.elapsed().as_secs_f64() * 1e9 / OBSERVATIONS as f64;
            if round >= WARM_ROUNDS {
                nanoseconds[index].push(elapsed);
            }
        }
    }
    Ok(nanoseconds)
}
