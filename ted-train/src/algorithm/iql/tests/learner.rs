//! The learner as a whole: schedule, lanes, saving and going on, and the backends against each other.

use crate::algorithm::fixtures::{batch, batch_of};
use crate::algorithm::iql::{Iql, IqlConfig};
use crate::checkpoint::Checkpoint;
use crate::nn::Backend;
use crate::nn::fixtures::{BACKENDS, assert_close, bits, values, wide};
use crate::rng::Seed;

use super::{config, learner};

/// Every number that a lane has, by tensor.
fn state(iql: &Iql, lane: usize) -> Vec<(String, Vec<f32>)> {
    let Checkpoint { tensors, .. } = iql.checkpoint(lane, [0; 32]);
    tensors.into_iter().map(|t| (t.name, t.values)).collect()
}

fn state_bits(iql: &Iql, lane: usize) -> Vec<(String, Vec<u32>)> {
    let state = state(iql, lane).into_iter();
    state.map(|(name, values)| (name, bits(&values))).collect()
}

#[test]
fn the_actor_s_rate_falls_along_a_cosine_to_zero_and_stays_there() {
    let config = IqlConfig {
        learning_rate: 0.5,
        steps: 1000,
        ..IqlConfig::default()
    };
    assert_eq!(config.actor_rate(0), 0.5);
    assert!((config.actor_rate(500) - 0.25).abs() < 1e-15);
    assert_eq!(config.actor_rate(1000), 0.0);
    assert_eq!(config.actor_rate(1500), 0.0);
    assert_eq!(config.actor_rate(2000), 0.0);
    let rates: Vec<f64> = (0..=1000).map(|step| config.actor_rate(step)).collect();
    assert!(rates.is_sorted_by(|earlier, later| earlier > later));
}

#[test]
fn fresh_networks_are_orthogonal_with_gain_sqrt_2_and_have_no_bias() {
    let iql = Iql::new(IqlConfig::default(), 39, 4, &[Seed::root(1)], Backend::Flex);
    for (name, network) in [
        ("value", &iql.value),
        ("actor", &iql.actor),
        ("critic", &iql.critic),
    ] {
        let layers = network.parameters.layers();
        for layer in [&layers[0], &layers[2]] {
            let [members, inputs, outputs] = layer.weight.dims();
            assert!(
                values(layer.bias.clone()).iter().all(|&b| b == 0.0),
                "{name}"
            );
            let weights = wide(&values(layer.weight.clone()));
            for member in weights.chunks(weights.len() / members) {
                // The shorter side is the orthonormal one.
                let longer = inputs.max(outputs);
                let at = |short: usize, long: usize| match inputs < outputs {
                    true => member[short * outputs + long],
                    false => member[long * outputs + short],
                };
                for (i, j) in [(0, 0), (inputs.min(outputs) - 1, 0)] {
                    let product: f64 = (0..longer).map(|k| at(i, k) * at(j, k)).sum();
                    let expected = if i == j { 2.0 } else { 0.0 };
                    assert!((product - expected).abs() < 1e-5, "{name}: {product}");
                }
            }
        }
    }
}

#[test]
fn lanes_side_by_side_learn_to_the_bit_what_each_learns_alone() {
    for backend in BACKENDS {
        let mut together = learner(&config(), &[1, 2], backend);
        let mut alone = [1, 2].map(|seed| learner(&config(), &[seed], backend));
        for step in 0..10 {
            together.update(&batch(&[1, 2], step));
            for (seed, lane) in [1, 2].into_iter().zip(&mut alone) {
                lane.update(&batch(&[seed], step));
            }
        }
        for (lane, alone) in alone.iter().enumerate() {
            let (there, here) = (state_bits(&together, lane), state_bits(alone, 0));
            assert_eq!(there, here, "{backend:?}, lane {lane}");
            assert_eq!(together.actors()[lane], alone.actors()[0]);
        }
    }
}

#[test]
fn lanes_of_full_size_learn_to_the_bit_what_each_learns_alone() {
    let full = |seeds: &[u64], backend| {
        let seeds: Vec<_> = seeds.iter().map(|&seed| Seed::root(seed)).collect();
        Iql::new(IqlConfig::default(), 39, 4, &seeds, backend)
    };
    for backend in BACKENDS {
        let mut together = full(&[1, 2, 3], backend);
        let mut alone = full(&[2], backend);
        for step in 0..2 {
            together.update(&batch_of([256, 39, 4], &[1, 2, 3], step));
            alone.update(&batch_of([256, 39, 4], &[2], step));
        }
        assert!(
            state_bits(&together, 1) == state_bits(&alone, 0),
            "{backend:?}"
        );
    }
}

#[test]
fn a_lane_begun_in_company_goes_on_alone_and_in_other_company_to_the_bit() {
    for backend in BACKENDS {
        let mut straight = learner(&config(), &[2], backend);
        let mut begun = learner(&config(), &[1, 2, 3], backend);
        for step in 0..5 {
            straight.update(&batch(&[2], step));
            begun.update(&batch(&[1, 2, 3], step));
        }
        let [first, second, third] = [0, 1, 2].map(|lane| begun.checkpoint(lane, [7; 32]));
        // Other seeds, so that whatever is not restored shows.
        let mut alone = learner(&config(), &[9], backend);
        alone.restore(&[&second]).unwrap();
        let mut turned = learner(&config(), &[8, 9], backend);
        turned.restore(&[&third, &second]).unwrap();
        for step in 5..10 {
            straight.update(&batch(&[2], step));
            alone.update(&batch(&[2], step));
            turned.update(&batch(&[3, 2], step));
        }
        let expected = state_bits(&straight, 0);
        assert_eq!(state_bits(&alone, 0), expected, "{backend:?}");
        assert_eq!(state_bits(&turned, 1), expected, "{backend:?}");
        assert_ne!(first, second);
    }
}

#[test]
fn a_lane_that_is_no_number_any_more_leaves_the_bits_of_the_others() {
    for backend in BACKENDS {
        let mut alone = learner(&config(), &[1], backend);
        let mut together = learner(&config(), &[2, 1, 3], backend);
        for step in 0..5 {
            alone.update(&batch(&[1], step));
            let mut all = batch(&[2, 1, 3], step);
            all.rewards[0] = f32::NAN;
            all.observations[0] = f32::INFINITY;
            let losses = together.update(&all).read();
            assert!(losses[0].critic_loss.is_nan());
            assert!(losses[1].critic_loss.is_finite() && losses[2].critic_loss.is_finite());
        }
        let (there, here) = (state_bits(&together, 1), state_bits(&alone, 0));
        assert_eq!(there, here, "{backend:?}");
    }
}

#[test]
fn a_restored_learner_goes_on_to_the_bit() {
    for backend in BACKENDS {
        let mut straight = learner(&config(), &[1], backend);
        for step in 0..5 {
            straight.update(&batch(&[1], step));
        }
        let saved = straight.checkpoint(0, [7; 32]);
        // Another seed, so that whatever is not restored shows.
        let mut restored = learner(&config(), &[2], backend);
        restored.restore(&[&saved]).unwrap();
        assert_eq!(restored.checkpoint(0, [7; 32]), saved);
        for step in 5..10 {
            straight.update(&batch(&[1], step));
            restored.update(&batch(&[1], step));
        }
        assert_eq!(restored.step(), 10);
        assert_eq!(
            state_bits(&restored, 0),
            state_bits(&straight, 0),
            "{backend:?}"
        );
    }
}

#[test]
fn a_checkpoint_of_another_learner_is_refused_by_the_tensor_it_lacks() {
    let saved = learner(&config(), &[1], Backend::Flex).checkpoint(0, [0; 32]);
    let wider = IqlConfig {
        hidden: vec![5, 7],
        ..config()
    };
    let error = learner(&wider, &[1], Backend::Flex)
        .restore(&[&saved])
        .unwrap_err();
    assert!(
        error
            .to_string()
            .contains("no value/1/weight of shape [1, 5, 7]"),
        "{error}"
    );

    let mut without = saved.clone();
    without
        .tensors
        .retain(|t| t.name != "adam/critic/second/2/bias");
    let error = learner(&config(), &[1], Backend::Flex)
        .restore(&[&without])
        .unwrap_err();
    assert!(
        error.to_string().contains("no adam/critic/second/2/bias"),
        "{error}"
    );
}

#[test]
fn the_backends_agree_after_fifty_updates() {
    /// They sum in different orders, and fifty updates at a high rate carry that on.
    const TOLERANCE: f64 = 1e-4;
    let [fused, flex, ndarray, cuda] = BACKENDS.map(|backend| {
        let mut iql = learner(&config(), &[1], backend);
        (0..50).for_each(|step| drop(iql.update(&batch(&[1], step))));
        state(&iql, 0)
    });
    for other in [fused, ndarray, cuda] {
        for ((name, flex), (_, other)) in flex.iter().zip(&other) {
            assert_close(other, &wide(flex), TOLERANCE, name);
        }
    }
    let fresh = state(&learner(&config(), &[1], Backend::Flex), 0);
    assert_ne!(fresh[0], flex[0], "they learned something");
}

#[test]
fn the_metrics_of_a_lane_are_those_it_has_alone() {
    for backend in BACKENDS {
        let read = |seeds: &[u64]| {
            let mut iql = learner(&config(), seeds, backend);
            iql.update(&batch(seeds, 0)).read()
        };
        assert_eq!(read(&[1, 2]), [read(&[1]), read(&[2])].concat());
    }
}

#[test]
fn lanes_after_different_updates_do_not_go_on_together() {
    let mut ahead = learner(&config(), &[1], Backend::Flex);
    ahead.update(&batch(&[1], 0));
    let ahead = ahead.checkpoint(0, [0; 32]);
    let behind = learner(&config(), &[2], Backend::Flex).checkpoint(0, [0; 32]);
    let mut both = learner(&config(), &[1, 2], Backend::Flex);
    let error = both.restore(&[&ahead, &behind]).unwrap_err();
    assert!(
        error.to_string().contains("after updates [1, 0]"),
        "{error}"
    );
    assert!(
        both.restore(&[&behind]).is_err(),
        "one checkpoint for two lanes"
    );
}
