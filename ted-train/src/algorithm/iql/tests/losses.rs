//! The three losses and their gradients: by hand on a few numbers, by central differences on many.

use crate::algorithm::iql::{IqlConfig, critic_loss, expectile_loss, policy_loss};
use crate::nn::fixtures::{BACKENDS, assert_close, numbers, tensor, values, wide};
use crate::nn::scalar::central_differences;

const LANES: usize = 2;
const BATCH: usize = 5;
const ACTION: usize = 3;

#[test]
fn the_expectile_loss_weighs_the_two_sides_as_derived_by_hand() {
    for backend in BACKENDS {
        let t = |v: &[f32]| tensor(v, [1, 4, 1], backend);
        // u = 1, -1, 0, -1.5 with weights 0.7, 0.3, 0.7, 0.3.
        let (loss, d_v) = expectile_loss(t(&[1.0, 0.0, 2.0, -1.0]), t(&[0.0, 1.0, 2.0, 0.5]), 0.7);
        assert_close(&values(loss), &[(0.7 + 0.3 + 0.675) / 4.0], 1e-6, "loss");
        assert_close(&values(d_v), &[-0.35, 0.15, 0.0, 0.225], 1e-6, "d_v");
    }
}

#[test]
fn the_policy_loss_is_the_weighted_likelihood_derived_by_hand() {
    let config = IqlConfig {
        beta: 2.0,
        ..IqlConfig::default()
    };
    for backend in BACKENDS {
        let pair = |v: &[f32]| tensor(v, [1, 2, 2], backend);
        // Standard deviations 1 and 2, weights exp(0) = 1 and exp(2 ln(3) / 2) = 3, z = (1, 0.5) and (-1, 1).
        let (loss, d_mean, d_log_std) = policy_loss(
            pair(&[0.5, -0.5, 0.0, 0.25]),
            tensor(&[0.0, std::f32::consts::LN_2], [1, 1, 2], backend),
            pair(&[1.5, 0.5, -1.0, 2.25]),
            tensor(&[0.0, 3f32.ln() / 2.0], [1, 2, 1], backend),
            &config,
        );
        let constant = std::f64::consts::LN_2 + std::f64::consts::TAU.ln();
        let expected = (0.625 + constant + 3.0 * (1.0 + constant)) / 2.0;
        assert_close(&values(loss), &[expected], 1e-6, "loss");
        assert_close(&values(d_mean), &[-0.5, -0.125, 1.5, -0.75], 1e-6, "d_mean");
        assert_close(&values(d_log_std), &[0.0, 0.375], 1e-6, "d_log_std");
    }
}

#[test]
fn no_advantage_weighs_more_than_the_clip() {
    for backend in BACKENDS {
        // exp(3 * 2) is beyond the clip of 100, exp(3 * 1000) beyond every number.
        let (loss, d_mean, _) = policy_loss(
            tensor(&[0.0, 0.0], [1, 2, 1], backend),
            tensor(&[0.0], [1, 1, 1], backend),
            tensor(&[1.0, -1.0], [1, 2, 1], backend),
            tensor(&[2.0, 1000.0], [1, 2, 1], backend),
            &IqlConfig::default(),
        );
        let likelihood = -0.5 - 0.5 * std::f64::consts::TAU.ln();
        assert_close(&values(loss), &[-100.0 * likelihood], 1e-6, "loss");
        assert_close(&values(d_mean), &[-50.0, 50.0], 1e-6, "d_mean");
    }
}

#[test]
fn a_log_std_outside_its_range_counts_as_the_end_of_the_range_and_gets_no_gradient() {
    for backend in BACKENDS {
        let loss_at = |log_std: [f32; 4]| {
            let (loss, _, d_log_std) = policy_loss(
                tensor(&[0.0; 4], [1, 1, 4], backend),
                tensor(&log_std, [1, 1, 4], backend),
                tensor(&[0.01, 0.01, 9.0, 9.0], [1, 1, 4], backend),
                tensor(&[0.0], [1, 1, 1], backend),
                &IqlConfig::default(),
            );
            (values(loss), values(d_log_std))
        };
        let (outside, gradient) = loss_at([-5.5, -5.0, 2.0, 2.5]);
        assert_eq!(outside, loss_at([-5.0, -5.0, 2.0, 2.0]).0);
        // At the ends themselves: 1 - z^2 with z = 0.01 e^5 and z = 9 e^-2.
        let inside = [0.01 * 5f64.exp(), 9.0 * (-2f64).exp()].map(|z| 1.0 - z * z);
        assert_close(
            &gradient,
            &[0.0, inside[0], inside[1], 0.0],
            1e-5,
            "gradient",
        );
    }
}

#[test]
fn the_critic_loss_is_the_mean_square_of_each_head() {
    for backend in BACKENDS {
        let q = tensor(&[1.0, 0.0, 3.0, 5.0], [2, 2, 1], backend);
        // One target for both heads: errors 0, -2 and 2, 3.
        let y = tensor(&[1.0, 2.0], [1, 2, 1], backend);
        let (loss, d_q) = critic_loss(q, y);
        assert_close(&values(loss), &[2.0, 6.5], 1e-6, "loss");
        assert_close(&values(d_q), &[0.0, -2.0, 2.0, 3.0], 1e-6, "d_q");
    }
}

/// Splits numbers into one slice a lane.
fn lanes(all: &[f32]) -> Vec<Vec<f64>> {
    all.chunks(all.len() / LANES).map(wide).collect()
}

fn scalar_expectile(q: &[f64], v: &[f64], tau: f64) -> f64 {
    let term = |(q, v): (&f64, &f64)| {
        let u = q - v;
        (if u < 0.0 { 1.0 - tau } else { tau }) * u * u
    };
    q.iter().zip(v).map(term).sum::<f64>() / q.len() as f64
}

fn scalar_policy(
    mean: &[f64],
    log_std: &[f64],
    actions: &[f64],
    advantage: &[f64],
    config: &IqlConfig,
) -> f64 {
    let mut total = 0.0;
    for (row, advantage) in advantage.iter().enumerate() {
        let weight = (config.beta * advantage).exp().min(config.advantage_clip);
        for i in 0..ACTION {
            let log_std = log_std[i].clamp(config.log_std[0], config.log_std[1]);
            let z = (actions[row * ACTION + i] - mean[row * ACTION + i]) / log_std.exp();
            let log_density = -0.5 * z * z - log_std - 0.5 * std::f64::consts::TAU.ln();
            total -= weight * log_density;
        }
    }
    total / advantage.len() as f64
}

#[test]
fn every_gradient_is_the_finite_difference_of_its_loss_in_each_lane() {
    let config = IqlConfig::default();
    let [q, v, advantage] = ["q", "v", "advantage"].map(|name| numbers(LANES * BATCH, name));
    let [mean, actions] = ["mean", "actions"].map(|name| numbers(LANES * BATCH * ACTION, name));
    let log_std = numbers(LANES * ACTION, "log_std");
    for backend in BACKENDS {
        let column = |v: &[f32]| tensor(v, [LANES, BATCH, 1], backend);
        let wide_rows = |v: &[f32]| tensor(v, [LANES, BATCH, ACTION], backend);
        let (value_loss, d_v) = expectile_loss(column(&q), column(&v), 0.7);
        let (q_loss, d_q) = critic_loss(column(&q), column(&v));
        let (pi_loss, d_mean, d_log_std) = policy_loss(
            wide_rows(&mean),
            tensor(&log_std, [LANES, 1, ACTION], backend),
            wide_rows(&actions),
            column(&advantage),
            &config,
        );
        let [value_loss, d_v, q_loss, d_q, pi_loss, d_mean, d_log_std] =
            [value_loss, d_v, q_loss, d_q, pi_loss, d_mean, d_log_std].map(values);
        let gradient = |all: &[f32], lane: usize| {
            let size = all.len() / LANES;
            all[lane * size..(lane + 1) * size].to_vec()
        };
        let [q, v, advantage, mean, actions, log_std] =
            [&q, &v, &advantage, &mean, &actions, &log_std].map(|all| lanes(all));
        for lane in 0..LANES {
            let check =
                |name: &str, loss: f32, actual: Vec<f32>, at: &[f64], f: &dyn Fn(&[f64]) -> f64| {
                    assert_close(&[loss], &[f(at)], 1e-6, &format!("{name} loss"));
                    let expected = central_differences(at, f);
                    assert_close(&actual, &expected, 2e-6, &format!("{name} gradient"));
                };
            check(
                "value",
                value_loss[lane],
                gradient(&d_v, lane),
                &v[lane],
                &|v| scalar_expectile(&q[lane], v, 0.7),
            );
            check(
                "critic",
                q_loss[lane],
                gradient(&d_q, lane),
                &q[lane],
                &|q| {
                    let squares = q.iter().zip(&v[lane]).map(|(q, y)| (q - y) * (q - y));
                    squares.sum::<f64>() / BATCH as f64
                },
            );
            let policy = |mean: &[f64], log_std: &[f64]| {
                scalar_policy(mean, log_std, &actions[lane], &advantage[lane], &config)
            };
            check(
                "mean",
                pi_loss[lane],
                gradient(&d_mean, lane),
                &mean[lane],
                &|mean| policy(mean, &log_std[lane]),
            );
            check(
                "log std",
                pi_loss[lane],
                gradient(&d_log_std, lane),
                &log_std[lane],
                &|log_std| policy(&mean[lane], log_std),
            );
        }
    }
}
