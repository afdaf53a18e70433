//! The perceptron, its gradients and its optimiser against numbers made without them, on all backends.

use rand::rngs::ChaCha8Rng;

use super::fixtures::{BACKENDS, assert_close, bits, numbers, tensor, values, wide};
use super::scalar::{ScalarMlp, central_differences, flat};
use super::*;
use crate::rng::Seed;

const MEMBERS: usize = 3;
const BATCH: usize = 7;
const INPUTS: usize = 4;
const OUTPUTS: usize = 2;

fn seeds(members: usize) -> Vec<ChaCha8Rng> {
    let seed = |m| Seed::root(5).child(&format!("member/{m}")).rng();
    (0..members).map(seed).collect()
}

/// Biases included, because [`Initialiser::UniformFanIn`] draws them too.
fn network(rngs: &mut [ChaCha8Rng], output: Activation, backend: Backend) -> Mlp {
    let shape = MlpShape::new(INPUTS, &[5, 6], OUTPUTS, output);
    Mlp::new(&shape, Initialiser::UniformFanIn, rngs, backend)
}

#[test]
fn outputs_and_gradients_are_those_of_scalar_arithmetic_and_finite_differences() {
    for backend in BACKENDS {
        for output in [Activation::Linear, Activation::Tanh] {
            for input_members in [1, MEMBERS] {
                let what = format!("{backend:?}, {output:?}, {input_members} inputs");
                let network = network(&mut seeds(MEMBERS), output, backend);
                let x = numbers(input_members * BATCH * INPUTS, "x");
                let d_output = numbers(MEMBERS * BATCH * OUTPUTS, "d_output");
                let (y, tape) =
                    network.forward_tape(tensor(&x, [input_members, BATCH, INPUTS], backend));
                let y = values(y);
                let gradients =
                    network.gradients(tape, tensor(&d_output, [MEMBERS, BATCH, OUTPUTS], backend));
                for member in 0..MEMBERS {
                    let scalar = ScalarMlp::member(&network, member);
                    let own = |all: &[f32], of: usize, which: usize| {
                        let size = all.len() / of;
                        wide(&all[which * size..(which + 1) * size])
                    };
                    let x = own(&x, input_members, member % input_members);
                    let d = own(&d_output, MEMBERS, member);
                    let forward = |net: &ScalarMlp| -> Vec<f64> {
                        x.chunks(INPUTS).flat_map(|row| net.forward(row)).collect()
                    };
                    let y = &y[member * BATCH * OUTPUTS..(member + 1) * BATCH * OUTPUTS];
                    assert_close(y, &forward(&scalar), 1e-6, &format!("{what}: output"));
                    let expected = central_differences(&scalar.parameters, |p| {
                        let y = forward(&scalar.with(p));
                        y.iter().zip(&d).map(|(y, d)| y * d).sum()
                    });
                    let actual = flat(&gradients.layers(), member);
                    assert_close(&actual, &expected, 2e-6, &format!("{what}: gradient"));
                }
            }
        }
    }
}

#[test]
fn the_gradient_in_the_input_is_the_finite_difference_of_each_member() {
    for backend in BACKENDS {
        for output in [Activation::Linear, Activation::Tanh] {
            for input_members in [1, MEMBERS] {
                let network = network(&mut seeds(MEMBERS), output, backend);
                let x = numbers(input_members * BATCH * INPUTS, "x");
                let d_output = numbers(MEMBERS * BATCH * OUTPUTS, "d_output");
                let (_, tape) =
                    network.forward_tape(tensor(&x, [input_members, BATCH, INPUTS], backend));
                let d = tensor(&d_output, [MEMBERS, BATCH, OUTPUTS], backend);
                let actual = values(network.input_gradient(tape, d));
                for member in 0..MEMBERS {
                    let scalar = ScalarMlp::member(&network, member);
                    let x = &x[member % input_members * BATCH * INPUTS..][..BATCH * INPUTS];
                    let d = wide(&d_output[member * BATCH * OUTPUTS..][..BATCH * OUTPUTS]);
                    let expected = central_differences(&wide(x), |x| {
                        let y = x.chunks(INPUTS).flat_map(|row| scalar.forward(row));
                        y.zip(&d).map(|(y, d)| y * d).sum()
                    });
                    let actual = &actual[member * BATCH * INPUTS..][..BATCH * INPUTS];
                    let what = format!("{backend:?}, {output:?}, {input_members} inputs");
                    assert_close(actual, &expected, 2e-6, &what);
                }
            }
        }
    }
}

#[test]
fn projection_shrinks_a_matrix_above_the_limit_and_nothing_else() {
    for backend in BACKENDS {
        // Members with norms 5 and 2: the limit of 2.5 halves the first.
        let layer = Linear {
            weight: tensor(&[3.0, -4.0, 0.0, 2.0], [2, 2, 1], backend),
            bias: tensor(&[100.0, -100.0], [2, 1, 1], backend),
        };
        let mut network = Mlp::from_layers(vec![layer], Activation::Linear, backend);
        network.project(2.5);
        let layers = network.parameters.layers();
        assert_close(&flat(&layers, 0), &[1.5, -2.0, 100.0], 1e-6, "projected");
        assert_eq!(flat(&layers, 1), [0.0, 2.0, -100.0]);
    }
}

#[test]
fn a_member_of_a_stack_learns_to_the_bit_what_it_learns_alone() {
    for backend in BACKENDS {
        let x = numbers(MEMBERS * BATCH * INPUTS, "x");
        let d = numbers(MEMBERS * BATCH * OUTPUTS, "d_output");
        let trained = |members: std::ops::Range<usize>| {
            let count = members.len();
            let mut network = network(
                &mut seeds(MEMBERS)[members.clone()],
                Activation::Tanh,
                backend,
            );
            let mut state = AdamState::new(&network);
            let own = |all: &[f32]| {
                let size = all.len() / MEMBERS;
                all[members.start * size..members.end * size].to_vec()
            };
            for step in 1..=5 {
                let x = tensor(&own(&x), [count, BATCH, INPUTS], backend);
                let (y, tape) = network.forward_tape(x);
                let gradients =
                    network.gradients(tape, y + tensor(&own(&d), [count, BATCH, OUTPUTS], backend));
                Adam::default().step(&mut network, &mut state, gradients, 0.01, step);
            }
            network
        };
        let stacked = trained(0..MEMBERS);
        for member in 0..MEMBERS {
            let alone = trained(member..member + 1);
            assert_eq!(
                bits(&flat(&stacked.parameters.layers(), member)),
                bits(&flat(&alone.parameters.layers(), 0)),
                "{backend:?}, member {member}"
            );
        }
    }
}

#[test]
fn adam_moves_as_computed_by_hand() {
    // p = 1, rate 0.1, gradients 0.5, -0.25, 0.1 and the default constants. In exact arithmetic:
    // m = 0.05, 0.02, 0.028; v = 0.00025, 0.00031225, 0.00032193775;
    // m_hat = 0.5, 0.02/0.19, 0.028/0.271; v_hat = 0.25, 0.00031225/0.001999, 0.00032193775/0.002997001.
    let expected = [
        0.9,
        0.9 - 0.1 * (0.02 / 0.19) / (0.00031225f64 / 0.001999).sqrt(),
        0.9 - 0.1 * (0.02 / 0.19) / (0.00031225f64 / 0.001999).sqrt()
            - 0.1 * (0.028 / 0.271) / (0.00032193775f64 / 0.002997001).sqrt(),
    ];
    for backend in BACKENDS {
        let mut parameter = tensor(&[1.0], [1, 1, 1], backend);
        let mut moments = Moments::zeros_like(&parameter);
        for (step, (gradient, expected)) in (1..).zip([0.5, -0.25, 0.1].into_iter().zip(expected)) {
            let gradient = tensor(&[gradient], [1, 1, 1], backend);
            Adam::default().tensor(&mut parameter, &mut moments, gradient, 0.1, step);
            // The correction 1 - 0.999^t loses digits in single precision: 1e-6 is what is left.
            assert_close(&values(parameter.clone()), &[expected], 1e-6, "parameter");
        }
        assert_close(&values(moments.first), &[0.028], 1e-7, "first moment");
        assert_close(&values(moments.second), &[0.00032193775], 1e-9, "second");
    }
}

#[test]
fn adam_adds_epsilon_to_the_root_of_the_corrected_moment() {
    let adam = Adam {
        epsilon: 0.5,
        ..Adam::default()
    };
    for backend in BACKENDS {
        let mut parameter = tensor(&[0.0], [1, 1, 1], backend);
        let mut moments = Moments::zeros_like(&parameter);
        let gradient = tensor(&[0.25], [1, 1, 1], backend);
        adam.tensor(&mut parameter, &mut moments, gradient, 0.3, 1);
        // 0.25 / (0.25 + 0.5) of the rate.
        assert_close(&values(parameter), &[-0.1], 1e-6, "parameter");
    }
}

#[test]
fn momentum_moves_as_computed_by_hand() {
    // p = 1, momentum 0.9, rate 0.1, gradients 0.5, -0.25, 0.1: velocities 0.5, 0.2, 0.28.
    for backend in BACKENDS {
        let layer = |value: f32| Linear {
            weight: tensor(&[value], [1, 1, 1], backend),
            bias: tensor(&[0.0], [1, 1, 1], backend),
        };
        let mut network = Mlp::from_layers(vec![layer(1.0)], Activation::Linear, backend);
        let mut velocity = Velocity::zero(&network);
        for (gradient, expected) in [0.5, -0.25, 0.1].into_iter().zip([0.95, 0.93, 0.902]) {
            // With an input of 1, weight and bias have the same gradient.
            let (_, tape) = network.forward_tape(tensor(&[1.0], [1, 1, 1], backend));
            let gradients = network.gradients(tape, tensor(&[gradient], [1, 1, 1], backend));
            velocity.step(&mut network, gradients, 0.9, 0.1);
            let parameters = flat(&network.parameters.layers(), 0);
            assert_close(&parameters, &[expected, expected - 1.0], 1e-6, "moved");
        }
    }
}

#[test]
fn polyak_goes_the_given_share_of_the_way() {
    for backend in BACKENDS {
        let of = |weight: [f32; 2], bias: f32| {
            let layer = Linear {
                weight: tensor(&weight, [1, 2, 1], backend),
                bias: tensor(&[bias], [1, 1, 1], backend),
            };
            Mlp::from_layers(vec![layer], Activation::Linear, backend)
        };
        let mut target = of([1.0, -2.0], 0.0);
        target.polyak(&of([3.0, 2.0], 8.0), 0.25);
        assert_eq!(flat(&target.parameters.layers(), 0), [1.5, -1.0, 2.0]);
    }
}

#[test]
fn an_exported_member_is_the_controller_s_view_of_it() {
    for backend in BACKENDS {
        let network = network(&mut seeds(MEMBERS), Activation::Tanh, backend);
        let x = numbers(INPUTS, "x");
        let all = values(network.forward(tensor(&x, [1, 1, INPUTS], backend)));
        let members = ExportedMlp::members(&network);
        assert_eq!(members.len(), MEMBERS);
        for (member, burn) in members.iter().zip(all.chunks(OUTPUTS)) {
            let mut y = [0.0; OUTPUTS];
            let mut scratch = ted_core::Scratch::new();
            let view = member.view().unwrap();
            view.forward(&x, &mut scratch, &mut y).unwrap();
            assert_close(&y, &wide(burn), 1e-6, "controller");
        }
    }
}
