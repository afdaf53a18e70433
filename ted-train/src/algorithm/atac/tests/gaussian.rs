//! The squashed Gaussian: density and gradients.

use crate::algorithm::atac::Gaussian;
use crate::nn::fixtures::{BACKENDS, assert_close, numbers, tensor, values, wide};
use crate::nn::scalar::central_differences;

const LANES: usize = 2;
const BATCH: usize = 5;
const ACTION: usize = 3;
const STD: [f64; 2] = [0.5, 1.9];

/// `-log pi` of one coordinate whose value before tanh is `u`, from the density itself.
fn negative_log(mean: f64, raw: f64, u: f64) -> f64 {
    let std = raw.exp().clamp(STD[0], STD[1]);
    let z = (u - mean) / std;
    let normal = (-0.5 * z * z).exp() / (std * std::f64::consts::TAU.sqrt());
    -(normal / (1.0 - u.tanh().powi(2))).ln()
}

fn std(raw: f64) -> f64 {
    raw.exp().clamp(STD[0], STD[1])
}

/// The network's output of one lane as pairs of mean and log standard deviation, row after row.
fn pairs(output: &[f64]) -> Vec<(f64, f64)> {
    let of_row = |row: &[f64]| -> Vec<_> {
        let (mean, raw) = row.split_at(ACTION);
        mean.iter().copied().zip(raw.iter().copied()).collect()
    };
    output.chunks(2 * ACTION).flat_map(of_row).collect()
}

fn mean(terms: impl Iterator<Item = f64>) -> f64 {
    terms.sum::<f64>() / (BATCH * ACTION) as f64
}

#[test]
fn likelihood_entropy_and_samples_have_the_gradients_of_finite_differences_in_each_lane() {
    // Log standard deviations up to 1 in size, of which those beyond -0.69 and 0.64 are clipped.
    let output = numbers(LANES * BATCH * 2 * ACTION, "output");
    let actions = numbers(LANES * BATCH * ACTION, "actions");
    let noise = numbers(LANES * BATCH * ACTION, "noise");
    let d_action = numbers(LANES * BATCH * ACTION, "d_action");
    for backend in BACKENDS {
        let rows = |v: &[f32]| tensor(v, [LANES, BATCH, ACTION], backend);
        let gaussian = Gaussian::new(tensor(&output, [LANES, BATCH, 2 * ACTION], backend), STD);
        let (nll, d_nll) = gaussian.negative_log_likelihood(rows(&actions));
        let sample = gaussian.sample(rows(&noise));
        let (entropy, d_entropy) = sample.entropy();
        let d_sample = sample.through(rows(&d_action));
        let action = values(sample.action.clone());
        let [nll, d_nll, entropy, d_entropy, d_sample] =
            [nll, d_nll, entropy, d_entropy, d_sample].map(values);
        for lane in 0..LANES {
            let own = |all: &[f32]| {
                let size = all.len() / LANES;
                all[lane * size..(lane + 1) * size].to_vec()
            };
            let [x, actions, noise, d_action] =
                [&output, &actions, &noise, &d_action].map(|all| wide(&own(all)));
            let drawn = |x: &[f64]| -> Vec<f64> {
                let pairs = pairs(x).into_iter().zip(&noise);
                pairs.map(|((m, raw), e)| m + std(raw) * e).collect()
            };
            let expected: Vec<_> = drawn(&x).iter().map(|u| u.tanh()).collect();
            assert_close(&own(&action), &expected, 1e-6, "action");
            let check = |name: &str, gradient: &[f32], f: &dyn Fn(&[f64]) -> f64| {
                let expected = central_differences(&x, f);
                assert_close(
                    &own(gradient),
                    &expected,
                    2e-6,
                    &format!("{backend:?}, {name}"),
                );
            };
            let likelihood = |x: &[f64]| {
                let pairs = pairs(x).into_iter().zip(&actions);
                mean(pairs.map(|((m, raw), a)| negative_log(m, raw, a.atanh())))
            };
            assert_close(&nll[lane..=lane], &[likelihood(&x)], 1e-6, "likelihood");
            check("likelihood", &d_nll, &likelihood);
            let of_entropy = |x: &[f64]| {
                let pairs = pairs(x).into_iter().zip(drawn(x));
                mean(pairs.map(|((m, raw), u)| negative_log(m, raw, u)))
            };
            assert_close(&entropy[lane..=lane], &[of_entropy(&x)], 1e-6, "entropy");
            check("negative entropy", &d_entropy, &|x| -of_entropy(x));
            check("sample", &d_sample, &|x| {
                let drawn = drawn(x).into_iter().zip(&d_action);
                drawn.map(|(u, d)| u.tanh() * d).sum()
            });
        }
    }
}

#[test]
fn a_saturated_action_has_a_finite_likelihood_and_the_right_one() {
    for backend in BACKENDS {
        // Far out tanh is 1 in single precision, but log(1 - tanh(u)^2) = 2 (log 2 - u) still tells how far.
        let output = tensor(&[30.0, 0.0], [1, 1, 2], backend);
        let sample = Gaussian::new(output, STD).sample(tensor(&[0.0], [1, 1, 1], backend));
        let expected = 0.5 * std::f64::consts::TAU.ln() + 2.0 * (2f64.ln() - 30.0);
        assert_close(&values(sample.entropy().0), &[expected], 1e-6, "entropy");
        // The most extreme action of a batch.
        let limit = 1.0 - 1e-5f32;
        let gaussian = Gaussian::new(tensor(&[0.0; 4], [1, 1, 4], backend), STD);
        let (nll, _) =
            gaussian.negative_log_likelihood(tensor(&[limit, -limit], [1, 1, 2], backend));
        let expected = negative_log(0.0, 0.0, f64::from(limit).atanh());
        // The inverse of tanh loses three digits there: 1 - a has only as many left.
        assert_close(&values(nll), &[expected], 2e-3, "likelihood");
    }
}
