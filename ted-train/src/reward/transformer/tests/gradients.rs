//! The gradient of the loss against differences of the loss, parameter by parameter.

use crate::dataset::Segment;
use crate::nn::Backend;
use crate::nn::fixtures::{assert_close, numbers, tensor, values};
use crate::nn::transformer::Dropout;
use crate::reward::transformer::training::{loss, pair_clips};
use crate::rng::Seed;

use super::{HEADS, SEGMENT, config, dataset, transformer};

#[test]
fn the_gradient_along_a_direction_is_the_difference_of_the_loss() {
    /// Half of the way between the two losses: small against a parameter, large against rounding.
    const H: f32 = 1e-3;
    let dataset = dataset();
    let pair = |first, second| {
        [(first, 1), (second, 5)]
            .map(|(episode, start)| Segment::new(&dataset, episode, start, SEGMENT).unwrap())
    };
    let pairs = [pair(0, 1), pair(2, 3), pair(4, 5)];
    let labels = || tensor(&[1.0, 0.0, 0.5], [1, 3, 1], Backend::Flex);
    for head in HEADS {
        let transformer = transformer(&config(head), &dataset, Backend::Flex);
        let clips = pair_clips(&transformer, &dataset, &pairs);
        for dropout in [
            Dropout::none(),
            Dropout::of_update(0.2, Seed::root(3), 1, 2),
        ] {
            let loss_of = |network: &super::super::network::Network| -> f64 {
                let (scores, _) = network.scores(&clips, &dropout);
                values(loss(scores, labels()).0)[0].into()
            };
            let (scores, tape) = transformer.network.scores(&clips, &dropout);
            let (_, d_scores) = loss(scores, labels());
            let mut gradients = transformer.network.gradients(tape, d_scores);
            for (i, gradient) in gradients.tensors().into_iter().enumerate() {
                let dims = gradient.dims();
                let direction = numbers(dims.iter().product(), &format!("direction/{i}"));
                let length = direction.iter().map(|d| d * d).sum::<f32>().sqrt();
                let direction = tensor(&direction, dims, Backend::Flex).div_scalar(length);
                let moved = |by: f32| {
                    let mut network = transformer.network.clone();
                    let parameter = network.tensors().swap_remove(i);
                    *parameter = parameter.clone() + direction.clone().mul_scalar(by);
                    loss_of(&network)
                };
                let slope = (moved(H) - moved(-H)) / f64::from(2.0 * H);
                let along = (gradient.clone() * direction.clone()).sum();
                let along = along.into_scalar::<f32>();
                assert_close(
                    &[along],
                    &[slope],
                    1e-3,
                    &format!("{head:?}, parameter {i}"),
                );
            }
        }
    }
}
