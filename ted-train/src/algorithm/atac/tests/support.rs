//! What the algorithm is for, on a problem that can be looked at: actions in the data lie in [-0.6, 0.6] and the more the better;
//! what a larger one is worth, nobody has seen.

use crate::algorithm::Batch;
use crate::algorithm::atac::{Atac, AtacConfig};
use crate::nn::Backend;
use crate::nn::fixtures::numbers;
use crate::rng::Seed;

/// Largest action in the data.
const SEEN: f32 = 0.6;

/// The action of the policy that is learned with this weight of the Bellman error.
fn learned(beta: f64) -> f32 {
    const ROWS: usize = 64;
    let config = AtacConfig {
        steps: 3000,
        warm_start: 500,
        hidden: vec![32, 32],
        beta,
        fast_rate: 5e-3,
        slow_rate: 5e-4,
        ..AtacConfig::default()
    };
    let steps = config.steps;
    let mut atac = Atac::new(config, 1, 1, &[Seed::root(1)], Backend::Fused);
    for step in 0..steps {
        let draws = numbers(ROWS, &format!("a/{step}"));
        let actions: Vec<_> = draws.iter().map(|a| SEEN * a).collect();
        atac.update(&Batch {
            observations: numbers(ROWS, &format!("s/{step}")),
            next_observations: vec![0.0; ROWS],
            rewards: actions.iter().map(|a| 5.0 * a).collect(),
            actions,
            // Every episode ends after one step.
            discounts: vec![0.0; ROWS],
            ..Batch::default()
        });
    }
    let actor = atac.actors().swap_remove(0);
    let (mut action, mut scratch) = ([0.0], ted_core::Scratch::new());
    let view = actor.view().unwrap();
    view.forward(&[0.0], &mut scratch, &mut action).unwrap();
    action[0]
}

#[test]
fn it_does_better_than_the_data_and_stays_inside_it_where_a_critic_without_pessimism_leaves() {
    let action = learned(4.0);
    assert!(action > 0.5 * SEEN, "{action}: the data's mean is 0");
    assert!(action < 1.2 * SEEN, "{action}: nobody has seen that");
    let trusting = learned(1e9);
    assert!(trusting > 0.8, "{trusting}");
}
