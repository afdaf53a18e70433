//! What the algorithm is for: actions that pay off only a step later are done more, although nobody says which they were.

use crate::algorithm::Replay;
use crate::algorithm::awr::{Awr, AwrConfig};
use crate::dataset::{Dataset, EpisodeRecord, Shape};
use crate::nn::Backend;
use crate::nn::fixtures::numbers;
use crate::rng::Seed;

/// The policy's action at the start of an episode. An episode has two steps: the first action decides where the second begins, and
/// the second is paid for where that is.
fn learned(discount: f32) -> f32 {
    const EPISODES: usize = 500;
    let actions = numbers(2 * EPISODES, "actions");
    let episode = |actions: &[f32]| EpisodeRecord {
        observations: vec![0.0, actions[0], 0.0],
        actions: actions.to_vec(),
        rewards: vec![0.0, f64::from(actions[0])],
        terminations: vec![false, true],
        truncations: vec![false; 2],
        success: vec![false; 2],
        ..EpisodeRecord::default()
    };
    let records: Vec<_> = actions.chunks(2).map(episode).collect();
    let shape = Shape {
        observation: 1,
        action: 1,
    };
    let dataset = Dataset::from_records("ted/x-v0", shape, &records).unwrap();
    let replay = Replay::new(
        &dataset,
        dataset.rewards_true().to_vec(),
        [discount, 0.0].repeat(EPISODES),
    );
    let config = AwrConfig {
        steps: 3000,
        critic_steps: 100,
        actor_steps: 200,
        batch: 64,
        hidden: vec![16],
        actor_rate: 1e-3,
        value_scale: 1.0,
        ..AwrConfig::default()
    };
    let mut awr = Awr::new(config, 1, 1, &[Seed::root(1)], Backend::Fused);
    while awr.step() < awr.config().steps {
        awr.prepare(&[&replay]);
        let batch = replay.batch(Seed::root(2), awr.step(), awr.config().batch);
        awr.update(&batch);
    }
    let start = replay.standardised(0..1);
    let actor = awr.actors().swap_remove(0);
    let (mut action, mut scratch) = ([0.0], ted_core::Scratch::new());
    let view = actor.view().unwrap();
    view.forward(&start, &mut scratch, &mut action).unwrap();
    action[0]
}

#[test]
fn it_does_better_than_the_data_by_what_pays_off_later() {
    let action = learned(0.99);
    assert!(action > 0.4, "{action}: the data's mean is 0");
}

#[test]
fn a_transition_whose_discount_is_zero_is_not_credited_with_what_follows() {
    let action = learned(0.0);
    assert!(action.abs() < 0.2, "{action}");
}
