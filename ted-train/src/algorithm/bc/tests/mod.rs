//! Behaviour cloning against numbers derived by hand, scalar arithmetic, and a behaviour worth imitating.

use crate::algorithm::Batch;
use crate::algorithm::fixtures::{ACTION, OBSERVATION, ROWS, batch};
use crate::nn::fixtures::{BACKENDS, assert_close, bits, numbers, tensor, values, wide};
use crate::nn::scalar::{ScalarAdam, ScalarMlp, central_differences, flat};
use crate::nn::{Adam, Backend};
use crate::rng::Seed;

use super::{Bc, BcConfig, imitation_loss};

/// A small network, and a rate at which a few steps change everything visibly.
fn config() -> BcConfig {
    BcConfig {
        batch: ROWS,
        hidden: vec![5, 4],
        learning_rate: 0.01,
        ..BcConfig::default()
    }
}

fn learner(config: &BcConfig, seeds: &[u64], backend: Backend) -> Bc {
    let seeds: Vec<_> = seeds.iter().map(|&s| Seed::root(s)).collect();
    Bc::new(config.clone(), OBSERVATION, ACTION, &seeds, backend)
}

#[test]
fn the_loss_is_the_mean_square_over_rows_and_coordinates() {
    for backend in BACKENDS {
        let t = |v: &[f32]| tensor(v, [1, 2, 2], backend);
        // Errors 1, -2, 0, 0.5.
        let (loss, d) = imitation_loss(t(&[1.0, 0.0, 0.25, 0.0]), t(&[0.0, 2.0, 0.25, -0.5]));
        assert_close(&values(loss), &[(1.0 + 4.0 + 0.25) / 4.0], 1e-6, "loss");
        assert_close(&values(d), &[0.5, -1.0, 0.0, 0.25], 1e-6, "gradient");
    }
}

#[test]
fn updates_are_those_of_scalar_arithmetic_in_every_parameter() {
    let config = BcConfig {
        // Adam divides small gradients by their own size; with a larger epsilon rounding is not blown up by that.
        adam: Adam {
            epsilon: 1e-2,
            ..Adam::default()
        },
        ..config()
    };
    for backend in BACKENDS {
        let mut bc = learner(&config, &[1], backend);
        let mut reference = ScalarMlp::member(&bc.policy, 0);
        let mut adam = ScalarAdam::new(config.adam, reference.parameters.len());
        for step in 0..3 {
            let batch = batch(&[1], step);
            bc.update(&batch);
            let (s, a) = (wide(&batch.observations), wide(&batch.actions));
            let gradient = central_differences(&reference.parameters, |p| {
                let policy = reference.with(p);
                let error = |(s, a): (&[f64], &[f64])| -> f64 {
                    let errors = policy.forward(s).into_iter().zip(a);
                    errors.map(|(p, a)| (p - a) * (p - a)).sum()
                };
                let rows = s.chunks(OBSERVATION).zip(a.chunks(ACTION));
                rows.map(error).sum::<f64>() / (ROWS * ACTION) as f64
            });
            adam.step(&mut reference.parameters, &gradient, config.learning_rate);
            let actual = flat(&bc.policy.parameters.layers(), 0);
            let what = format!("{backend:?}, update {}", step + 1);
            assert_close(&actual, &reference.parameters, 2e-6, &what);
        }
    }
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
fn a_lane_begun_in_company_and_restored_alone_goes_on_to_the_bit() {
    let all = |bc: &Bc| -> Vec<_> {
        let tensors = bc.checkpoint(0, [0; 32]).tensors.into_iter();
        tensors.map(|t| (t.name, bits(&t.values))).collect()
    };
    for backend in BACKENDS {
        let mut straight = learner(&config(), &[2], backend);
        let mut begun = learner(&config(), &[1, 2], backend);
        for step in 0..5 {
            straight.update(&batch(&[2], step));
            begun.update(&batch(&[1, 2], step));
        }
        let saved = begun.checkpoint(1, [7; 32]);
        // Another seed, so that whatever is not restored shows.
        let mut restored = learner(&config(), &[3], backend);
        restored.restore(&[&saved]).unwrap();
        assert_eq!(restored.checkpoint(0, [7; 32]), saved);
        for step in 5..10 {
            straight.update(&batch(&[2], step));
            restored.update(&batch(&[2], step));
        }
        assert_eq!(restored.step(), 10);
        assert_eq!(all(&restored), all(&straight), "{backend:?}");
    }
}

#[test]
fn it_imitates_what_it_saw_and_the_mean_where_that_was_noisy() {
    /// Noise on the recorded actions: what is left of the loss when the policy is found.
    const NOISE: f32 = 0.2;
    let behaviour = |s: &[f32]| [(s[0] - s[1]).tanh() * 0.7, 0.3 * s[2]];
    let config = BcConfig {
        hidden: vec![32],
        ..config()
    };
    let mut bc = learner(&config, &[1], Backend::Fused);
    for step in 0..1500 {
        let rows = 64;
        let s = numbers(rows * OBSERVATION, &format!("s/{step}"));
        let noise = numbers(rows * ACTION, &format!("noise/{step}"));
        let a: Vec<f32> = s.chunks(OBSERVATION).flat_map(behaviour).collect();
        bc.update(&Batch {
            observations: s,
            actions: a.iter().zip(noise).map(|(a, n)| a + NOISE * n).collect(),
            rewards: vec![0.0; rows],
            ..Batch::default()
        });
    }
    let s = numbers(100 * OBSERVATION, "unseen");
    let policy = values(
        bc.policy
            .forward(tensor(&s, [1, 100, OBSERVATION], Backend::Fused)),
    );
    let expected: Vec<f32> = s.chunks(OBSERVATION).flat_map(behaviour).collect();
    // A third of the noise's own spread; a policy that does nothing is off by 0.7.
    assert_close(&policy, &wide(&expected), 0.07, "imitated");
}
