//! The transformer against arithmetic one number at a time, its gradients against differences of that.

mod reference;

use burn::tensor::Tensor;

use super::{Dropout, Readout, Sequences, Transformer, TransformerShape};
use crate::nn::Backend;
use crate::nn::fixtures::{assert_close, bits, numbers, tensor, values, wide};
use crate::nn::scalar::central_differences;
use crate::rng::Seed;
use reference::Reference;

const BURN: [Backend; 2] = [Backend::Flex, Backend::Ndarray];
const WIDTH: usize = 4;
const PAIRS: Readout = Readout {
    group: 2,
    offset: 1,
};

fn shape(layers: usize, causal: bool) -> TransformerShape {
    TransformerShape {
        width: WIDTH,
        layers,
        heads: 2,
        causal,
    }
}

fn sequences(readout: Readout) -> Sequences {
    Sequences {
        count: 2,
        tokens: 6,
        readout,
    }
}

/// A transformer whose gains and biases are not those of a fresh one.
fn transformer(shape: &TransformerShape, backend: Backend) -> Transformer {
    let device = backend.device();
    let mut transformer = Transformer::new(shape, &mut Seed::root(5).rng(), &device);
    for (i, parameter) in transformer.tensors().into_iter().enumerate() {
        let dims = parameter.dims();
        let noise = numbers(dims.iter().product(), &format!("noise/{i}"));
        *parameter = parameter.clone() + tensor(&noise, dims, backend).mul_scalar(0.3);
    }
    transformer
}

fn parameters(transformer: &Transformer) -> Vec<Vec<f64>> {
    let mut transformer = transformer.clone();
    let tensors = transformer.tensors().into_iter();
    tensors.map(|t| wide(&values(t.clone()))).collect()
}

fn input(sequences: Sequences) -> Vec<f32> {
    numbers(sequences.count * sequences.tokens * WIDTH, "x")
}

fn dropouts() -> [Dropout; 3] {
    let of_update = |copies| Dropout::of_update(0.3, Seed::root(9), 4, copies);
    [Dropout::none(), of_update(1), of_update(2)]
}

fn cases() -> Vec<(TransformerShape, Sequences, Dropout)> {
    let mut cases = Vec::new();
    for (layers, causal) in [(1, true), (2, true), (2, false)] {
        for readout in [Readout::ALL, PAIRS] {
            for dropout in dropouts() {
                cases.push((shape(layers, causal), sequences(readout), dropout));
            }
        }
    }
    cases
}

#[test]
fn outputs_are_those_of_plain_arithmetic() {
    for (shape, sequences, dropout) in cases() {
        let x = input(sequences);
        for backend in BURN {
            let transformer = transformer(&shape, backend);
            let rows = [1, sequences.count * sequences.tokens, WIDTH];
            let (y, _) = transformer.forward(tensor(&x, rows, backend), sequences, &dropout);
            let reference = Reference {
                shape,
                sequences,
                dropout: &dropout,
            };
            let expected = reference.forward(&parameters(&transformer), &wide(&x));
            assert_close(&values(y), &expected, 1e-5, "output");
        }
    }
}

#[test]
fn gradients_are_the_differences_of_plain_arithmetic() {
    for (shape, sequences, dropout) in cases() {
        let x = input(sequences);
        let rows = sequences.count * sequences.tokens;
        let read = sequences.readout.rows(rows);
        // A loss that is linear in the outputs; its slopes are the gradient that goes in.
        let slopes = numbers(read * WIDTH, "slopes");
        let transformer = transformer(&shape, Backend::Flex);
        let all = parameters(&transformer);
        let reference = Reference {
            shape,
            sequences,
            dropout: &dropout,
        };
        let loss = |parameters: &[Vec<f64>], x: &[f64]| -> f64 {
            let y = reference.forward(parameters, x);
            y.iter().zip(&slopes).map(|(y, s)| y * f64::from(*s)).sum()
        };
        let x_in = tensor(&x, [1, rows, WIDTH], Backend::Flex);
        let (_, tape) = transformer.forward(x_in, sequences, &dropout);
        let slopes_in = tensor(&slopes, [1, read, WIDTH], Backend::Flex);
        let (mut gradients, d_x) = transformer.backward(tape, slopes_in);

        let expected = central_differences(&wide(&x), |x| loss(&all, x));
        assert_close(&values(d_x), &expected, 2e-4, "input");
        for (i, gradient) in gradients.tensors().into_iter().enumerate() {
            let expected = central_differences(&all[i], |moved| {
                let mut all = all.clone();
                all[i] = moved.to_vec();
                loss(&all, &wide(&x))
            });
            let what = format!("parameter {i} of {shape:?}");
            assert_close(&values(gradient.clone()), &expected, 2e-4, &what);
        }
    }
}

#[test]
fn a_causal_transformer_does_not_see_what_comes_later() {
    let sequences = sequences(Readout::ALL);
    let transformer = transformer(&shape(2, true), Backend::Flex);
    let run = |x: &[f32]| {
        let x = tensor(x, [1, 12, WIDTH], Backend::Flex);
        bits(&values(
            transformer.forward(x, sequences, &Dropout::none()).0,
        ))
    };
    let (x, mut changed) = (input(sequences), input(sequences));
    // Token 3 of the first sequence.
    changed[3 * WIDTH] += 1.0;
    let (before, after) = (run(&x), run(&changed));
    assert_eq!(before[..3 * WIDTH], after[..3 * WIDTH]);
    assert_eq!(before[6 * WIDTH..], after[6 * WIDTH..], "another sequence");
    for token in 3..6 {
        let row = token * WIDTH..(token + 1) * WIDTH;
        assert_ne!(before[row.clone()], after[row], "token {token} sees it");
    }
}

#[test]
fn tokens_that_are_read_alone_come_out_as_they_do_among_all() {
    let transformer = transformer(&shape(2, true), Backend::Flex);
    let run = |readout| {
        let sequences = sequences(readout);
        let x = tensor(&input(sequences), [1, 12, WIDTH], Backend::Flex);
        values(transformer.forward(x, sequences, &Dropout::none()).0)
    };
    let all = run(Readout::ALL);
    let read: Vec<f32> = all
        .chunks(2 * WIDTH)
        .flat_map(|p| p[WIDTH..].to_vec())
        .collect();
    assert_close(&run(PAIRS), &wide(&read), 1e-6, "read tokens");
}

#[test]
fn masks_are_functions_of_stream_update_and_place_and_keep_the_mean() {
    let device = Backend::Flex.device();
    let mask = |rate, update, place: &str| -> Vec<f32> {
        let dropout = Dropout::of_update(rate, Seed::root(1), update, 2);
        let mask: Tensor<3> = dropout.mask(place, [2, 300, 200], &device).unwrap();
        values(mask)
    };
    let first = mask(0.1, 7, "here");
    assert_eq!(first, mask(0.1, 7, "here"));
    assert_ne!(first, mask(0.1, 8, "here"));
    assert_ne!(first, mask(0.1, 7, "there"));
    let (one, other) = first.split_at(60_000);
    assert_eq!(one, other, "copies share their masks");
    let dropped = one.iter().filter(|&&m| m == 0.0).count() as f64 / 60_000.0;
    assert!((dropped - 0.1).abs() < 0.005, "{dropped}");
    let mean = one.iter().map(|&m| f64::from(m)).sum::<f64>() / 60_000.0;
    assert!((mean - 1.0).abs() < 0.01, "{mean}");
    // The second job's numbers are not the first one's once more.
    assert_ne!(one[..10_000], one[1 << 15..][..10_000]);
}

#[test]
fn the_number_of_threads_shows_in_no_bit() {
    let shape = TransformerShape {
        width: 64,
        layers: 2,
        heads: 4,
        causal: true,
    };
    let sequences = Sequences {
        count: 8,
        tokens: 60,
        readout: PAIRS,
    };
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| {
            let device = Backend::Flex.device();
            let transformer = Transformer::new(&shape, &mut Seed::root(1).rng(), &device);
            let dropout = Dropout::of_update(0.1, Seed::root(2), 0, 2);
            let x = tensor(&numbers(480 * 64, "x"), [1, 480, 64], Backend::Flex);
            let (y, tape) = transformer.forward(x, sequences, &dropout);
            let (mut gradients, d_x) = transformer.backward(tape, y.clone());
            let mut all = vec![bits(&values(y)), bits(&values(d_x))];
            all.extend(
                gradients
                    .tensors()
                    .into_iter()
                    .map(|g| bits(&values(g.clone()))),
            );
            all
        })
    };
    let one = run(1);
    for threads in [2, 3] {
        assert_eq!(run(threads), one, "{threads} threads");
    }
}
