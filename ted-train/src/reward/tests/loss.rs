//! Bradley-Terry by hand, at its extremes, and by central differences.

use crate::nn::fixtures::{BACKENDS, assert_close, numbers, tensor, values, wide};
use crate::nn::scalar::central_differences;
use crate::reward::loss::bradley_terry;

#[test]
fn cross_entropy_is_as_derived_by_hand() {
    let (ln2, ln3) = (std::f64::consts::LN_2, 3f32.ln());
    // Logits 0, ln 3 and ln 3 against labels 0.5, 1 and 0: p = 1/2, 3/4, 3/4.
    let by_hand = (ln2 + (4f64 / 3.0).ln() + 4f64.ln()) / 3.0;
    let slopes = [0.0, -0.25, 0.75].map(|slope| slope / 3.0);
    for backend in BACKENDS {
        let returns = [7.0, 7.0, 1.0, 1.0 + ln3, -ln3, 0.0];
        let (loss, d_returns) = bradley_terry(
            tensor(&returns, [1, 3, 2], backend),
            tensor(&[0.5, 1.0, 0.0], [1, 3, 1], backend),
        );
        assert_close(&values(loss), &[by_hand], 1e-6, "loss");
        let expected: Vec<f64> = slopes.iter().flat_map(|s| [-s, *s]).collect();
        assert_close(&values(d_returns), &expected, 1e-6, "gradient");
    }
}

#[test]
fn returns_far_apart_neither_overflow_nor_lose_their_gradient() {
    for backend in BACKENDS {
        let (loss, d_returns) = bradley_terry(
            tensor(&[0.0, 500.0, 0.0, -500.0], [2, 1, 2], backend),
            tensor(&[0.0, 0.0], [2, 1, 1], backend),
        );
        assert_close(&values(loss), &[500.0, 0.0], 1e-6, "loss");
        assert_close(&values(d_returns), &[-1.0, 1.0, 0.0, 0.0], 1e-6, "gradient");
    }
}

#[test]
fn the_gradient_is_the_finite_difference_for_each_member_and_label() {
    const MEMBERS: usize = 2;
    const PAIRS: usize = 3;
    let returns: Vec<f32> = numbers(MEMBERS * PAIRS * 2, "returns")
        .iter()
        .map(|r| 4.0 * r)
        .collect();
    let labels = [0.0, 0.5, 1.0, 1.0, 0.0, 0.5];
    for backend in BACKENDS {
        let (loss, d_returns) = bradley_terry(
            tensor(&returns, [MEMBERS, PAIRS, 2], backend),
            tensor(&labels, [MEMBERS, PAIRS, 1], backend),
        );
        let (loss, d_returns) = (values(loss), values(d_returns));
        for member in 0..MEMBERS {
            let labels = wide(&labels[member * PAIRS..(member + 1) * PAIRS]);
            let range = member * PAIRS * 2..(member + 1) * PAIRS * 2;
            // As the paper writes it, with the probability of the second segment.
            let cross_entropy = |returns: &[f64]| -> f64 {
                let term = |(pair, y): (&[f64], &f64)| {
                    let p = pair[1].exp() / (pair[0].exp() + pair[1].exp());
                    -(y * p.ln() + (1.0 - y) * (1.0 - p).ln())
                };
                returns.chunks(2).zip(&labels).map(term).sum::<f64>() / PAIRS as f64
            };
            let own = wide(&returns[range.clone()]);
            assert_close(&loss[member..=member], &[cross_entropy(&own)], 1e-6, "loss");
            let expected = central_differences(&own, cross_entropy);
            assert_close(&d_returns[range], &expected, 1e-6, "gradient");
        }
    }
}
