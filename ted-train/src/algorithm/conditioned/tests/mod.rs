//! Conditioned behaviour cloning against numbers derived by hand, scalar arithmetic, and logs with something to choose.

use crate::algorithm::fixtures::{ACTION, OBSERVATION, ROWS, batch};
use crate::nn::fixtures::{BACKENDS, assert_close, bits, numbers, tensor, values, wide};
use crate::nn::scalar::{ScalarAdam, ScalarMlp, central_differences, flat};
use crate::nn::{Activation, Adam, Backend, ExportedMlp, Mlp};
use crate::rng::Seed;

use super::losses::{ConditionedLoss, conditioned_loss};
use super::update::GAIN_RATE;
use super::{Conditioned, ConditionedConfig};

mod choice;

/// A small network, and a rate at which a few steps change everything visibly.
fn config() -> ConditionedConfig {
    ConditionedConfig {
        steps: 20,
        batch: ROWS,
        hidden: vec![5, 4],
        learning_rate: 0.01,
        ..ConditionedConfig::default()
    }
}

fn learner(config: &ConditionedConfig, seeds: &[u64], backend: Backend) -> Conditioned {
    let seeds: Vec<_> = seeds.iter().map(|&s| Seed::root(s)).collect();
    Conditioned::new(config.clone(), OBSERVATION, ACTION, &seeds, backend)
}

/// Every tensor of the first lane.
fn all(learner: &Conditioned) -> Vec<(String, Vec<u32>)> {
    let tensors = learner.checkpoint(0, [0; 32]).tensors.into_iter();
    tensors.map(|t| (t.name, bits(&t.values))).collect()
}

#[test]
fn the_loss_is_the_mean_square_over_rows_and_coordinates_at_each_row_s_condition() {
    for backend in BACKENDS {
        let t = |v: &[f32], width| tensor(v, [1, 2, width], backend);
        // f0 = (1, 0), h = (2, -1), c = 0.5; f0 = (0.5, 1), h = (3, 1), c = -1; the gain is 2.
        let heads = t(&[1.0, 0.0, 2.0, -1.0, 0.5, 1.0, 3.0, 1.0], 4);
        let (conditions, actions) = (t(&[0.5, -1.0], 1), t(&[1.0, 0.5, -2.5, 0.5], 2));
        let gain = tensor(&[2.0], [1, 1, 1], backend);
        let of = conditioned_loss(heads, gain, conditions, actions);
        // Errors 2, -1; -1, -2.5.
        let loss = (4.0 + 1.0 + 1.0 + 6.25) / 4.0;
        assert_close(&values(of.loss), &[loss], 1e-6, "loss");
        let expected = [2.0, -1.0, 0.5, -0.25, 0.5, 1.25, 0.5, 1.25];
        assert_close(&values(of.d_heads), &expected, 1e-6, "gradient");
        assert_close(&values(of.d_gain), &[2.0], 1e-6, "of the gain");
    }
}

/// `((1 + c gain) f0 + c h - a)^2` of one row, summed over its coordinates.
fn squares(heads: &[f64], gain: f64, c: f64, a: impl IntoIterator<Item = f64>) -> f64 {
    let (average, other) = heads.split_at(ACTION);
    let parts = average.iter().zip(other).zip(a);
    let errors = parts.map(|((f0, h), a)| (1.0 + c * gain) * f0 + c * h - a);
    errors.map(|e| e * e).sum()
}

#[test]
fn the_gradient_is_the_slope_of_the_loss() {
    let [heads, c, a] = [2 * ACTION, 1, ACTION].map(|width| numbers(ROWS * width, "loss"));
    let gain = 0.75;
    for backend in BACKENDS {
        let t = |v: &[f32], width| tensor(v, [1, ROWS, width], backend);
        // The last number is the gain.
        let loss_of = |all: &[f64]| -> f64 {
            let (&gain, heads) = all.split_last().unwrap();
            let rows = heads.chunks(2 * ACTION).zip(&c).zip(a.chunks(ACTION));
            let errors = rows.map(|((heads, &c), a)| {
                squares(heads, gain, c.into(), a.iter().map(|&a| a.into()))
            });
            errors.sum::<f64>() / (ROWS * ACTION) as f64
        };
        let of_gain = tensor(&[gain], [1, 1, 1], backend);
        let ConditionedLoss {
            loss,
            d_heads,
            d_gain,
        } = conditioned_loss(t(&heads, 2 * ACTION), of_gain, t(&c, 1), t(&a, ACTION));
        let all = [wide(&heads), vec![gain.into()]].concat();
        assert_close(&values(loss), &[loss_of(&all)], 1e-6, "loss");
        let slopes = [values(d_heads), values(d_gain)].concat();
        assert_close(
            &slopes,
            &central_differences(&all, loss_of),
            1e-6,
            "gradient",
        );
    }
}

#[test]
fn updates_are_those_of_scalar_arithmetic_in_every_parameter_and_every_average() {
    let config = ConditionedConfig {
        // Adam divides small gradients by their own size; with a larger epsilon rounding is not blown up by that.
        adam: Adam {
            epsilon: 1e-2,
            ..Adam::default()
        },
        ..config()
    };
    // Half a cosine over 20 updates from 0.01 to 1e-5, and shares 10 / (t + 10) of an average that is short.
    let rates = [0u32, 1, 2].map(|step| {
        let fallen = 0.5 * (1.0 - (std::f64::consts::PI * f64::from(step) / 20.0).cos());
        0.01 - (0.01 - 1e-5) * fallen
    });
    let shares = [10.0 / 11.0, 10.0 / 12.0, 10.0 / 13.0];
    for backend in BACKENDS {
        let mut learner = learner(&config, &[1], backend);
        let mut reference = ScalarMlp::member(&learner.network, 0);
        let mut average = reference.parameters.clone();
        let mut adam = ScalarAdam::new(config.adam, average.len());
        let (mut gain, mut average_gain) = ([0.0], 0.0);
        let mut gain_adam = ScalarAdam::new(config.adam, 1);
        for step in 0..3 {
            let batch = batch(&[1], step as u64);
            let read = learner.update(&batch).read();
            let (s, a) = (wide(&batch.observations), wide(&batch.actions));
            let c = wide(&batch.conditions);
            // The last number is the gain.
            let loss_of = |all: &[f64]| {
                let (&gain, p) = all.split_last().unwrap();
                let policy = reference.with(p);
                let rows = s.chunks(OBSERVATION).zip(&c).zip(a.chunks(ACTION));
                let errors = rows
                    .map(|((s, &c), a)| squares(&policy.forward(s), gain, c, a.iter().copied()));
                errors.sum::<f64>() / (ROWS * ACTION) as f64
            };
            let all = [&reference.parameters[..], &gain].concat();
            let loss = loss_of(&all);
            let mut gradient = central_differences(&all, loss_of);
            let d_gain = gradient.pop().unwrap();
            let kept = 1.0 - rates[step] * config.weight_decay;
            reference.parameters.iter_mut().for_each(|p| *p *= kept);
            adam.step(&mut reference.parameters, &gradient, rates[step]);
            gain_adam.step(&mut gain, &[d_gain], rates[step] * GAIN_RATE);
            for (average, new) in average.iter_mut().zip(&reference.parameters) {
                *average += shares[step] * (new - *average);
            }
            average_gain += shares[step] * (gain[0] - average_gain);
            let what = format!("{backend:?}, update {}", step + 1);
            assert_close(&[read[0].policy_loss], &[loss], 1e-5, &what);
            let flat = |network: &Mlp| flat(&network.parameters.layers(), 0);
            assert_close(&flat(&learner.network), &reference.parameters, 2e-6, &what);
            assert_close(&flat(&learner.average), &average, 2e-6, &what);
            assert_close(&values(learner.gain.clone()), &gain, 2e-6, &what);
            assert_close(
                &values(learner.average_gain.clone()),
                &[average_gain],
                2e-6,
                &what,
            );
        }
    }
}

#[test]
fn the_rate_falls_to_the_last() {
    let config = ConditionedConfig {
        steps: 50_000,
        ..ConditionedConfig::default()
    };
    let rates = [0, 25_000, 50_000].map(|step| config.rate(step));
    for (rate, expected) in rates.into_iter().zip([1e-3, 5.05e-4, 1e-5]) {
        assert!((rate - expected).abs() < 1e-12, "{rate}");
    }
}

#[test]
fn lanes_side_by_side_learn_to_the_bit_what_each_learns_alone() {
    for backend in BACKENDS {
        let mut together = learner(&config(), &[1, 2], backend).flown_at(&[0.25, 1.0]);
        let mut alone = [(1, 0.25), (2, 1.0)]
            .map(|(seed, advance)| learner(&config(), &[seed], backend).flown_at(&[advance]));
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
fn a_lane_begun_in_company_and_restored_alone_goes_on_to_the_bit_and_flies_where_it_was_trusted() {
    for backend in BACKENDS {
        let mut straight = learner(&config(), &[2], backend).flown_at(&[0.5]);
        let mut begun = learner(&config(), &[1, 2], backend).flown_at(&[1.0, 0.5]);
        for step in 0..5 {
            straight.update(&batch(&[2], step));
            begun.update(&batch(&[1, 2], step));
        }
        let saved = begun.checkpoint(1, [7; 32]);
        // Another seed and another trust, so that whatever is not restored shows.
        let mut restored = learner(&config(), &[3], backend);
        restored.restore(&[&saved]).unwrap();
        assert_eq!(restored.checkpoint(0, [7; 32]), saved);
        for step in 5..10 {
            straight.update(&batch(&[2], step));
            restored.update(&batch(&[2], step));
        }
        assert_eq!(restored.step(), 10);
        assert_eq!(all(&restored), all(&straight), "{backend:?}");
        assert_eq!(restored.actors(), straight.actors(), "{backend:?}");
    }
}

#[test]
fn what_flies_is_the_average_of_both_halves_at_the_aim() {
    let s = numbers(50 * OBSERVATION, "unseen");
    for backend in BACKENDS {
        let flights = [
            (1.0, 0.6, 1.0),
            (0.75, 1.0, 1.0),
            (2.0, 0.5, 0.25),
            (1.0, 0.0, 1.0),
            (1.0, 0.6, 0.0),
        ];
        for (aim, haste, advance) in flights {
            let config = ConditionedConfig {
                aim,
                haste,
                ..config()
            };
            let mut learner = learner(&config, &[1], backend).flown_at(&[advance]);
            (0..10).for_each(|step| drop(learner.update(&batch(&[1], step))));
            let s = || tensor(&s, [1, 50, OBSERVATION], backend);
            let heads = wide(&values(learner.average.forward(s())));
            let condition = aim * f64::from(advance);
            let gain = f64::from(values(learner.average_gain.clone())[0]);
            assert!(gain.abs() > 0.01, "{gain}");
            let longer = 1.0 + condition * haste * gain;
            let expected: Vec<f64> = heads
                .chunks(2 * ACTION)
                .flat_map(|row| (0..ACTION).map(|i| longer * row[i] + condition * row[ACTION + i]))
                .collect();
            let actor: ExportedMlp = learner.actors().remove(0);
            assert_eq!(actor.output, Activation::Linear);
            let flown = values(Mlp::from_exported(&actor, backend).forward(s()));
            assert_close(
                &flown,
                &expected,
                2e-6,
                &format!("{backend:?}, {condition}"),
            );
            if condition == 0.0 {
                let both = &ExportedMlp::members(&learner.average)[0];
                let halves = both.layers.last().unwrap().bias.split_at(ACTION);
                assert_eq!(actor.layers.last().unwrap().bias, halves.0);
            }
        }
    }
}
