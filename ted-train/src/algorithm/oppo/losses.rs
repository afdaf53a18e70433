//! Losses with their gradients. Latents are few numbers, so what concerns them is plain arithmetic.

use burn::tensor::Tensor;

/// Added to a difference before its length is taken, as PyTorch's triplet loss does.
const EPSILON: f32 = 1e-6;

/// What the triplet loss says of a batch of pairs.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Triplet {
    /// Mean over the pairs.
    pub(super) loss: f32,
    /// Gradient in the latents of the first clips, then of the second ones, `[2 * pairs][latent]`.
    pub(super) d_latents: Vec<f32>,
    /// Gradient in the anchor.
    pub(super) d_anchor: Vec<f32>,
}

/// `mean of max(d(anchor, better) - d(anchor, worse) + margin, 0)` of latents `[2 * pairs][latent]`, first clips first. A
/// label is the probability that the second clip is better; where it is 0.5 the first takes the better one's place and
/// there is no margin.
pub(super) fn triplet(anchor: &[f32], latents: &[f32], labels: &[f32], margin: f32) -> Triplet {
    let (size, pairs) = (anchor.len(), labels.len());
    let mut result = Triplet {
        loss: 0.0,
        d_latents: vec![0.0; latents.len()],
        d_anchor: vec![0.0; size],
    };
    for (pair, &label) in labels.iter().enumerate() {
        let sides = [pair, pairs + pair];
        let [better, worse] = if label > 0.5 {
            [sides[1], sides[0]]
        } else {
            sides
        };
        let margin = if label == 0.5 { 0.0 } else { margin };
        let [near, far] = [better, worse].map(|at| distance(anchor, &latents[at * size..][..size]));
        let excess = near.length - far.length + margin;
        if excess <= 0.0 {
            continue;
        }
        result.loss += excess / pairs as f32;
        for (at, distance, sign) in [(better, &near, 1.0), (worse, &far, -1.0)] {
            let d_latents = &mut result.d_latents[at * size..][..size];
            let both = d_latents.iter_mut().zip(&mut result.d_anchor);
            for ((d_latent, d_anchor), direction) in both.zip(&distance.direction) {
                let d = sign * direction / pairs as f32;
                *d_anchor += d;
                *d_latent -= d;
            }
        }
    }
    result
}

struct Distance {
    length: f32,
    /// From the latent to the anchor, of length 1.
    direction: Vec<f32>,
}

fn distance(anchor: &[f32], latent: &[f32]) -> Distance {
    let both = anchor.iter().zip(latent);
    let mut direction: Vec<f32> = both.map(|(a, z)| a - z + EPSILON).collect();
    let length = length(&direction);
    direction.iter_mut().for_each(|d| *d /= length.max(EPSILON));
    Distance { length, direction }
}

fn length(vector: &[f32]) -> f32 {
    vector.iter().map(|x| x * x).sum::<f32>().sqrt()
}

/// `max(|z| - 1, 0)` of latents `[2 * pairs][size]`: the mean over first clips plus that over second ones, and its gradient.
pub(super) fn excess_length(latents: &[f32], size: usize) -> (f32, Vec<f32>) {
    let pairs = (latents.len() / size / 2) as f32;
    let mut d_latents = vec![0.0; latents.len()];
    let mut loss = 0.0;
    for (z, d) in latents
        .chunks_exact(size)
        .zip(d_latents.chunks_exact_mut(size))
    {
        let length = length(z);
        if length > 1.0 {
            loss += (length - 1.0) / pairs;
            d.iter_mut()
                .zip(z)
                .for_each(|(d, z)| *d = z / length / pairs);
        }
    }
    (loss, d_latents)
}

/// Mean squared error and its gradient in the prediction.
pub(super) fn squared_error(prediction: Tensor<3>, target: Tensor<3>) -> (f32, Tensor<3>) {
    let count = prediction.dims().iter().product::<usize>() as f64;
    let error = prediction - target;
    let squares = super::update::numbers(&error);
    // In order, whatever the number of threads.
    let loss = squares.iter().map(|x| f64::from(x * x)).sum::<f64>() / count;
    let loss = loss as f32;
    (loss, error.mul_scalar(2.0 / count))
}
