//! The learner as a whole: first state, phases, lanes, saving and going on, export.

use crate::algorithm::fixtures::{ACTION, OBSERVATION, ROWS, batch};
use crate::nn::Backend;
use crate::nn::fixtures::{BACKENDS, assert_close, bits, numbers, tensor, values, wide};

use super::{config, learner};
use crate::algorithm::atac::Atac;

fn state_bits(atac: &Atac) -> Vec<(String, Vec<u32>)> {
    let tensors = atac.checkpoint(0, [0; 32]).tensors.into_iter();
    tensors.map(|t| (t.name, bits(&t.values))).collect()
}

#[test]
fn a_fresh_policy_has_a_standard_deviation_of_one_and_a_mean_that_depends_on_what_it_sees() {
    for backend in BACKENDS {
        let atac = learner(&config(), &[1, 2], backend);
        let x = numbers(ROWS * OBSERVATION, "x");
        let x = tensor(&x, [1, ROWS, OBSERVATION], backend);
        let output = atac.policy.forward(x);
        let log_std = values(output.clone().narrow(2, ACTION, ACTION));
        assert_eq!(log_std, vec![0.0; 2 * ROWS * ACTION]);
        let mean = values(output.narrow(2, 0, ACTION));
        assert!(mean.iter().all(|m| *m != 0.0) && mean[0] != mean[ACTION]);
    }
}

#[test]
fn the_noise_of_an_update_is_normal_and_a_function_of_lane_and_update() {
    let mut atac = learner(&config(), &[1, 2], Backend::Flex);
    let [here, next] = atac.noise(1000, ACTION).map(values);
    for noise in [&here, &next] {
        let moment = |n: i32| {
            let sum: f64 = wide(noise).iter().map(|x| x.powi(n)).sum();
            sum / noise.len() as f64
        };
        // Three of their own standard deviations: 4000 draws.
        assert!(moment(1).abs() < 3.0 / 4000f64.sqrt(), "{}", moment(1));
        assert!((moment(2) - 1.0).abs() < 3.0 * (2.0 / 4000f64).sqrt());
    }
    assert_ne!(here, next);
    assert_ne!(here[..2000], here[2000..], "lanes");
    atac.step = 1;
    assert_ne!(values(atac.noise(1000, ACTION)[0].clone()), here);
    atac.step = 0;
    assert_eq!(values(atac.noise(1000, ACTION)[0].clone()), here);
    let alone = learner(&config(), &[2], Backend::Flex);
    assert_eq!(values(alone.noise(1000, ACTION)[0].clone()), here[2000..]);
}

#[test]
fn lanes_side_by_side_learn_to_the_bit_what_each_learns_alone() {
    for backend in BACKENDS {
        let mut together = learner(&config(), &[1, 2], backend);
        let mut alone = [1, 2].map(|seed| learner(&config(), &[seed], backend));
        for step in 0..10 {
            let metrics = together.update(&batch(&[1, 2], step)).read();
            for (lane, seed) in [1, 2].into_iter().enumerate() {
                let own = alone[lane].update(&batch(&[seed], step)).read();
                assert_eq!(own, metrics[lane..=lane], "{backend:?}");
            }
        }
        for (there, alone) in together.actors().iter().zip(&alone) {
            assert_eq!(*there, alone.actors()[0], "{backend:?}");
        }
    }
}

#[test]
fn a_lane_begun_in_company_goes_on_alone_to_the_bit_from_the_warm_start_from_its_end_and_from_later()
 {
    for backend in BACKENDS {
        for stop in [2, 3, 5] {
            let mut straight = learner(&config(), &[2], backend);
            let mut begun = learner(&config(), &[1, 2], backend);
            for step in 0..stop {
                straight.update(&batch(&[2], step));
                begun.update(&batch(&[1, 2], step));
            }
            let saved = begun.checkpoint(1, [7; 32]);
            // The same seed, for its noise, but somewhere else, so that whatever is not restored shows.
            let mut restored = learner(&config(), &[2], backend);
            (0..7).for_each(|step| drop(restored.update(&batch(&[9], step))));
            restored.restore(&[&saved]).unwrap();
            assert_eq!(restored.checkpoint(0, [7; 32]), saved);
            for step in stop..8 {
                straight.update(&batch(&[2], step));
                restored.update(&batch(&[2], step));
            }
            assert_eq!(restored.step(), 8);
            assert_eq!(state_bits(&restored), state_bits(&straight), "{backend:?}");
        }
    }
}

#[test]
fn a_checkpoint_without_a_tensor_is_refused_by_its_name() {
    let mut saved = learner(&config(), &[1], Backend::Flex).checkpoint(0, [0; 32]);
    saved.tensors.retain(|t| t.name != "target/1/2/bias");
    let mut atac = learner(&config(), &[1], Backend::Flex);
    let error = atac.restore(&[&saved]).unwrap_err().to_string();
    assert!(error.contains("no target/1/2/bias"), "{error}");
}

#[test]
fn what_flies_is_tanh_of_the_mean_and_nothing_else_of_the_policy() {
    for backend in BACKENDS {
        let mut atac = learner(&config(), &[1, 2], backend);
        (0..5).for_each(|step| drop(atac.update(&batch(&[1, 2], step))));
        let x = numbers(OBSERVATION, "x");
        let output = atac
            .policy
            .forward(tensor(&x, [1, 1, OBSERVATION], backend));
        let actions = values(output.narrow(2, 0, ACTION).tanh());
        for (actor, action) in atac.actors().iter().zip(actions.chunks(ACTION)) {
            let (mut y, mut scratch) = ([0.0; ACTION], ted_core::Scratch::new());
            let view = actor.view().unwrap();
            view.forward(&x, &mut scratch, &mut y).unwrap();
            assert_close(&y, &wide(action), 1e-6, "controller");
        }
    }
}
