//! The two losses and their gradients: by hand and by central differences.

use crate::algorithm::awr::{regression_loss, value_loss};
use crate::nn::fixtures::{BACKENDS, assert_close, numbers, tensor, values, wide};
use crate::nn::scalar::central_differences;

#[test]
fn the_value_loss_is_half_the_mean_square() {
    for backend in BACKENDS {
        let t = |v: &[f32]| tensor(v, [1, 2, 1], backend);
        let (loss, d_v) = value_loss(t(&[1.0, 0.0]), t(&[0.5, 2.0]));
        assert_close(&values(loss), &[0.5 * (0.25 + 4.0) / 2.0], 1e-6, "loss");
        assert_close(&values(d_v), &[0.25, -1.0], 1e-6, "gradient");
    }
}

#[test]
fn the_regression_is_a_weighted_likelihood_with_the_gradient_of_finite_differences() {
    const STD: f64 = 0.4;
    let (mean, actions) = (numbers(2 * 3 * 2, "mean"), numbers(2 * 3 * 2, "actions"));
    let weights = [0.5, 3.0, 0.1, 1.0, 0.0, 20.0];
    for backend in BACKENDS {
        let rows = |v: &[f32]| tensor(v, [2, 3, 2], backend);
        let weight = tensor(&weights, [2, 3, 1], backend);
        let (loss, d_mean) = regression_loss(rows(&mean), rows(&actions), weight, STD);
        let (loss, d_mean) = (values(loss), values(d_mean));
        for lane in 0..2 {
            let own = 6 * lane..6 * (lane + 1);
            let (a, w) = (wide(&actions[own.clone()]), &weights[3 * lane..]);
            let f = |mean: &[f64]| {
                let density = |(m, a): (&f64, &f64)| {
                    let z = (a - m) / STD;
                    ((-0.5 * z * z).exp() / (STD * std::f64::consts::TAU.sqrt())).ln()
                };
                let row = |row: usize| -> f64 {
                    let pairs = mean[2 * row..].iter().zip(&a[2 * row..]).take(2);
                    -f64::from(w[row]) * pairs.map(density).sum::<f64>()
                };
                (0..3).map(row).sum::<f64>() / 3.0
            };
            let mean = wide(&mean[own.clone()]);
            assert_close(&loss[lane..=lane], &[f(&mean)], 1e-6, "loss");
            let expected = central_differences(&mean, f);
            assert_close(&d_mean[own], &expected, 1e-5, "gradient");
        }
    }
}
