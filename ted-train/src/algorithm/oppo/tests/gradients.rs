//! The gradients of both networks against differences of the loss, parameter by parameter.

use burn::tensor::Tensor;

use crate::algorithm::oppo::Oppo;
use crate::algorithm::oppo::losses::squared_error;
use crate::algorithm::oppo::networks::{Clips, Prediction};
use crate::dataset::Segment;
use crate::nn::Backend;
use crate::nn::fixtures::{assert_close, numbers, tensor, values};
use crate::nn::transformer::Dropout;
use crate::rng::Seed;

use super::{SEGMENT, config, dataset};

/// A loss of everything the two networks say, as the update puts it together.
fn loss(oppo: &Oppo, clips: &Clips, dropout: &Dropout) -> (f64, Prediction) {
    let (z, _) = oppo.encoder.forward(clips, dropout);
    let (prediction, _) = oppo.policy.forward(z, clips, dropout);
    let (of_actions, actions) = squared_error(prediction.actions, clips.actions.clone());
    let (of_observations, observations) =
        squared_error(prediction.observations, clips.observations.clone());
    let d = Prediction {
        actions,
        observations,
    };
    (f64::from(of_actions) + f64::from(of_observations), d)
}

#[test]
fn the_gradient_along_a_direction_is_the_difference_of_the_loss() {
    /// Half of the way between the two losses: small against a parameter, large against rounding.
    const H: f32 = 1e-3;
    let dataset = dataset();
    let oppo = Oppo::new(&config(), &dataset, Seed::root(2), Backend::Flex).unwrap();
    let clips = [(0, 0), (3, 2), (5, 1)]
        .map(|(episode, start)| Segment::new(&dataset, episode, start, SEGMENT).unwrap());
    let clips = oppo.clips(&dataset, &clips);
    for dropout in [
        Dropout::none(),
        Dropout::of_update(0.2, Seed::root(3), 1, 1),
    ] {
        let (z, encoded) = oppo.encoder.forward(&clips, &dropout);
        let (_, tape) = oppo.policy.forward(z, &clips, &dropout);
        let (mut policy, d_z) = oppo.policy.backward(tape, loss(&oppo, &clips, &dropout).1);
        let mut encoder = oppo.encoder.backward(encoded, d_z);

        type Tensors = fn(&mut Oppo) -> Vec<&mut Tensor<3>>;
        let networks: [(&str, Vec<&mut Tensor<3>>, Tensors); 2] = [
            ("policy", policy.tensors(), |oppo| oppo.policy.tensors()),
            ("encoder", encoder.tensors(), |oppo| oppo.encoder.tensors()),
        ];
        for (name, gradients, tensors) in networks {
            for (i, gradient) in gradients.into_iter().enumerate() {
                let dims = gradient.dims();
                let direction = numbers(dims.iter().product(), &format!("{name}/{i}"));
                let length = direction.iter().map(|d| d * d).sum::<f32>().sqrt();
                let direction = tensor(&direction, dims, Backend::Flex).div_scalar(length);
                let moved = |by: f32| {
                    let mut oppo = oppo.clone();
                    let parameter = tensors(&mut oppo).swap_remove(i);
                    *parameter = parameter.clone() + direction.clone().mul_scalar(by);
                    loss(&oppo, &clips, &dropout).0
                };
                let slope = (moved(H) - moved(-H)) / f64::from(2.0 * H);
                let along = values(gradient.clone() * direction.clone()).iter().sum();
                assert_close(&[along], &[slope], 5e-3, &format!("{name}, parameter {i}"));
            }
        }
    }
}

#[test]
fn an_action_is_predicted_without_being_seen_and_from_all_that_came_before() {
    let dataset = dataset();
    let oppo = Oppo::new(&config(), &dataset, Seed::root(2), Backend::Flex).unwrap();
    let segment = Segment::new(&dataset, 1, 1, SEGMENT).unwrap();
    let predict = |clips: &Clips| {
        let (prediction, _) = oppo
            .policy
            .forward(oppo.latent.clone(), clips, &Dropout::none());
        values(prediction.actions)
    };
    let clips = oppo.clips(&dataset, &[segment]);
    let before = predict(&clips);
    let with = |channel: &dyn Fn(&mut Clips)| {
        let mut clips = clips.clone();
        channel(&mut clips);
        let after = predict(&clips);
        (0..4)
            .filter(|&step| before[step] != after[step])
            .collect::<Vec<_>>()
    };
    let nudge = |rows: usize, width: usize| {
        let mut nudge = vec![0.0; rows * width];
        nudge[width] = 1.0;
        tensor(&nudge, [1, rows, width], Backend::Flex)
    };
    // Of the second of four steps.
    let action = with(&|clips| clips.actions = clips.actions.clone() + nudge(4, 1));
    assert_eq!(action, [2, 3]);
    let observation = with(&|clips| clips.observations = clips.observations.clone() + nudge(4, 2));
    assert_eq!(observation, [1, 2, 3]);
    assert_eq!(with(&|clips| clips.starts = vec![0]), [0, 1, 2, 3]);
}
