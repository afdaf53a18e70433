//! The fast engine against the plain one, in shapes that fill panels, tiles and blocks and in those that do not, and against
//! itself on other numbers of threads.

use crate::nn::fixtures::{bits, numbers, tensor, values};
use crate::nn::scalar::flat;
use crate::nn::{Activation, Adam, AdamState, Backend, Initialiser, Linear, Mlp, MlpShape};
use crate::rng::Seed;
use crate::tolerance::NETWORK_FUSED;

use super::Buffer;

const MEMBERS: usize = 2;

/// Inputs, hidden widths, outputs and rows of a batch: a narrow and a wide last layer, none hidden, the learner's shapes.
const SHAPES: [(usize, &[usize], usize, usize); 8] = [
    (39, &[256, 256], 1, 256),
    (43, &[256, 256], 4, 100),
    (3, &[5, 4], 2, 6),
    (33, &[31, 65], 9, 65),
    (64, &[32], 8, 64),
    (40, &[], 3, 7),
    (7, &[], 40, 129),
    (1, &[1], 1, 1),
];

/// A fresh network, the same on every engine.
fn network(shape: &(usize, &[usize], usize, usize), output: Activation, backend: Backend) -> Mlp {
    let (inputs, hidden, outputs, _) = *shape;
    let mut rngs = [1, 2].map(|seed| Seed::root(seed).rng());
    let shape = MlpShape::new(inputs, hidden, outputs, output);
    Mlp::new(&shape, Initialiser::UniformFanIn, &mut rngs, backend)
}

/// Outputs, gradients in the parameters and in the input, and the parameters after three updates towards zero output and then a
/// projection.
fn learned(
    shape: &(usize, &[usize], usize, usize),
    output: Activation,
    backend: Backend,
) -> [Vec<f32>; 5] {
    let (inputs, _, outputs, batch) = *shape;
    let mut network = network(shape, output, backend);
    let mut adam = AdamState::new(&network);
    // Rows for which no unit ends within rounding of its kink, where it would be on in one engine and off in the other: then
    // a gradient is off by 1e-4 and no engine is wrong.
    let x = numbers(batch * inputs, "rows");
    let x = tensor(&x, [1, batch, inputs], backend);
    let d = numbers(MEMBERS * batch * outputs, "d");
    let d = tensor(&d, [MEMBERS, batch, outputs], backend);
    let all = |layers: &[Linear]| (0..MEMBERS).flat_map(|m| flat(layers, m)).collect();
    let y = values(network.forward(x.clone()));
    let (again, tape) = network.forward_tape(x.clone());
    assert_eq!(bits(&values(again)), bits(&y), "with and without a tape");
    let gradients = all(&network.gradients(tape, d.clone()).layers());
    let (_, tape) = network.forward_tape(x.clone());
    let d_input = values(network.input_gradient(tape, d.clone()));
    for step in 1..=3 {
        let (y, tape) = network.forward_tape(x.clone());
        let gradients = network.gradients(tape, y * d.clone());
        // Adam divides small gradients by their own size, which blows rounding up unless epsilon is larger.
        let constants = Adam {
            epsilon: 1e-2,
            ..Adam::default()
        };
        constants.step(&mut network, &mut adam, gradients, 0.01, step);
    }
    let updated = all(&network.parameters.layers());
    // Below the norm of every weight matrix with more than a few numbers.
    network.project(1.0);
    let projected = all(&network.parameters.layers());
    [y, gradients, d_input, updated, projected]
}

#[test]
fn the_fast_engine_agrees_with_the_plain_one_in_every_shape() {
    for shape in &SHAPES {
        for output in [Activation::Linear, Activation::Tanh] {
            let plain = learned(shape, output, Backend::Flex);
            let fused = learned(shape, output, Backend::Fused);
            let what = ["output", "gradient", "input", "parameters", "projection"];
            for (what, (fused, plain)) in what.iter().zip(fused.iter().zip(&plain)) {
                assert_eq!(fused.len(), plain.len(), "{what} of {shape:?}");
                let length = |xs: &mut dyn Iterator<Item = f32>| {
                    xs.map(|x| f64::from(x).powi(2)).sum::<f64>().sqrt()
                };
                let error = length(&mut fused.iter().zip(plain).map(|(a, b)| a - b));
                let error = error / length(&mut plain.iter().copied());
                assert!(
                    NETWORK_FUSED.allowed.holds(error, 1),
                    "{what} of {shape:?}, {output:?}: {error}"
                );
            }
        }
    }
}

#[test]
fn the_number_of_threads_shows_in_no_bit() {
    for shape in &SHAPES {
        let [one, three] = [1, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.unwrap()
                .install(|| learned(shape, Activation::Tanh, Backend::Fused))
                .map(|numbers| bits(&numbers))
        });
        assert_eq!(one, three, "{shape:?}");
    }
}

#[test]
fn packed_parameters_come_back_to_the_bit() {
    for shape in &SHAPES {
        let plain = network(shape, Activation::Linear, Backend::Flex);
        let layers = plain.parameters.layers();
        let back = Buffer::from_layers(&layers).layers();
        for member in 0..MEMBERS {
            assert_eq!(bits(&flat(&back, member)), bits(&flat(&layers, member)));
        }
    }
}

#[test]
fn what_is_not_a_number_is_not_hidden_by_relu() {
    let shape = (2, &[3usize, 4][..], 1, 5);
    let network = network(&shape, Activation::Linear, Backend::Fused);
    let mut x = numbers(10, "x");
    x[4] = f32::NAN;
    let y = values(network.forward(tensor(&x, [1, 5, 2], Backend::Fused)));
    let finite: Vec<_> = y.iter().map(|y| y.is_finite()).collect();
    let expected = [true, true, false, true, true];
    assert_eq!(finite, expected.repeat(MEMBERS));
}
