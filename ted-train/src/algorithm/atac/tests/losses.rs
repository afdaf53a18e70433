//! The Bellman error and the weighing of losses, by hand.

use crate::algorithm::atac::{Shares, bellman_loss};
use crate::nn::fixtures::{BACKENDS, assert_close, tensor, values};

#[test]
fn the_bellman_error_and_its_gradients_are_those_derived_by_hand() {
    for backend in BACKENDS {
        let t = |v: [f32; 2]| tensor(&v, [1, 2, 1], backend);
        // Distances to the target 1 and -2; residuals 3 - 0.5 - 0.5 * 1 = 2 and 1 - 1 - 0 = 0: the second discount is that of a
        // terminal.
        let (q, q_next, y) = (t([3.0, 1.0]), t([1.0, 9.0]), t([2.0, 3.0]));
        let (loss, d_q, d_q_next) = bellman_loss(q, q_next, y, t([0.5, 1.0]), t([0.5, 0.0]));
        assert_close(
            &values(loss),
            &[0.5 * (1.0 + 4.0 + 4.0) / 2.0],
            1e-6,
            "loss",
        );
        assert_close(&values(d_q), &[1.5, -1.0], 1e-6, "d_q");
        assert_close(&values(d_q_next), &[-0.5, 0.0], 1e-6, "d_q_next");
    }
}

#[test]
fn neither_of_two_losses_weighs_more_than_it_does_alone() {
    for (weight, loss, penalty) in [(4.0, 0.25, 1.0), (1.0, 1.0, 1.0), (0.5, 1.0, 0.5)] {
        assert_eq!(Shares::of(weight), Shares { loss, penalty });
    }
    for backend in BACKENDS {
        let shares = Shares::of_lanes(tensor(&[4.0, 0.5], [2, 1, 1], backend));
        assert_eq!(values(shares.loss), [0.25, 1.0]);
        assert_eq!(values(shares.penalty), [1.0, 0.5]);
    }
}
