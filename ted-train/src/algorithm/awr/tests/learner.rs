//! The learner as a whole: first state, lanes, saving and going on.

use crate::algorithm::{Batch, Replay};
use crate::dataset::fixtures::SHAPE;
use crate::nn::Backend;
use crate::nn::fixtures::{BACKENDS, bits, values};
use crate::rng::Seed;

use super::{ROWS, config, dataset, learner, replay};
use crate::algorithm::awr::Awr;

/// The next update, on the batches of these lanes.
fn update(awr: &mut Awr, replays: &[&Replay<'_>]) -> Vec<crate::algorithm::awr::UpdateMetrics> {
    awr.prepare(replays);
    let batch = |replay: &&Replay<'_>| replay.batch(Seed::root(3), awr.step(), ROWS);
    let all = Batch::of_lanes(replays.iter().map(batch).collect());
    awr.update(&all).read()
}

fn state_bits(awr: &Awr) -> Vec<(String, Vec<u32>)> {
    let tensors = awr.checkpoint(0, [0; 32]).tensors.into_iter();
    tensors.map(|t| (t.name, bits(&t.values))).collect()
}

#[test]
fn a_fresh_policy_does_next_to_nothing() {
    for backend in BACKENDS {
        let awr = learner(&[1, 2], backend);
        let layers = awr.actor.parameters.layers();
        let last = values(layers[2].weight.clone());
        let limit = config().output_scale as f32;
        assert!(last.iter().all(|w| w.abs() <= limit));
        assert!(last.iter().any(|w| w.abs() > 0.5 * limit));
        // Uniform in plus or minus sqrt(6 / (inputs + outputs)).
        let first = values(layers[0].weight.clone());
        let bound = (6.0 / (SHAPE.observation as f32 + 5.0)).sqrt();
        assert!(first.iter().all(|w| w.abs() <= bound));
        assert!(first.iter().any(|w| w.abs() > 0.8 * bound));
    }
}

#[test]
fn each_phase_trains_its_network_and_leaves_the_other() {
    let (dataset, mut awr) = (dataset(), learner(&[1], Backend::Fused));
    let replay = replay(&dataset, 1);
    for step in 0..10 {
        let before = (awr.critic.clone(), awr.actor.clone());
        let metrics = update(&mut awr, &[&replay])[0];
        let changed = |old: &crate::nn::Mlp, new: &crate::nn::Mlp| {
            let of = |n: &crate::nn::Mlp| values(n.parameters.layers()[0].weight.clone());
            of(old) != of(new)
        };
        let (critic, actor) = (
            changed(&before.0, &awr.critic),
            changed(&before.1, &awr.actor),
        );
        assert_eq!((critic, actor), (step % 5 < 3, step % 5 >= 3), "{step}");
        assert_eq!(metrics.critic_loss.is_some(), critic);
        assert_eq!(metrics.policy_loss.is_some(), actor);
    }
}

#[test]
fn lanes_side_by_side_learn_to_the_bit_what_each_learns_alone() {
    let dataset = dataset();
    let (first, second) = (replay(&dataset, 1), replay(&dataset, 2));
    for backend in BACKENDS {
        let mut together = learner(&[1, 2], backend);
        let mut alone = [learner(&[1], backend), learner(&[2], backend)];
        for _ in 0..12 {
            let metrics = update(&mut together, &[&first, &second]);
            for (lane, replay) in [&first, &second].into_iter().enumerate() {
                assert_eq!(update(&mut alone[lane], &[replay]), metrics[lane..=lane]);
            }
        }
        for (there, alone) in together.actors().iter().zip(&alone) {
            assert_eq!(*there, alone.actors()[0], "{backend:?}");
        }
    }
}

#[test]
fn a_lane_begun_in_company_goes_on_alone_to_the_bit_wherever_in_an_iteration_it_stopped() {
    let dataset = dataset();
    let (other, own) = (replay(&dataset, 1), replay(&dataset, 2));
    for backend in BACKENDS {
        for stop in 5..10 {
            let mut straight = learner(&[2], backend);
            let mut begun = learner(&[1, 2], backend);
            for _ in 0..stop {
                update(&mut straight, &[&own]);
                update(&mut begun, &[&other, &own]);
            }
            let saved = begun.checkpoint(1, [7; 32]);
            // Another seed and another place, so that whatever is not restored shows.
            let mut restored = learner(&[3], backend);
            for _ in 0..stop + 1 {
                update(&mut restored, &[&other]);
            }
            restored.restore(&[&saved]).unwrap();
            assert_eq!(restored.checkpoint(0, [7; 32]), saved);
            while straight.step() < 13 {
                update(&mut straight, &[&own]);
                update(&mut restored, &[&own]);
            }
            let what = format!("{backend:?}, stopped after {stop}");
            assert_eq!(state_bits(&restored), state_bits(&straight), "{what}");
        }
    }
}
