//! Fitting a perceptron to numbers of the dataset's transitions by least squares, and asking it about all of them.

use burn::tensor::{Tensor, TensorData};
use firmware_sim::interrupt;
use firmware_sim::progress::Progress;
use rand::RngExt;

use crate::nn::{
    Activation, AdamState, Backend, Initialiser, Mlp, MlpShape, WarmupCosine, average_share,
};
use crate::reward::LearnError;
use crate::rng::Seed;

use super::Fitting;

/// What a network sees of a transition, and what it is to say of it: each appends the numbers of one step.
pub(super) struct Rows<'a> {
    /// Transitions there are.
    pub count: usize,
    /// Numbers that it sees.
    pub inputs: usize,
    /// Numbers that it says.
    pub outputs: usize,
    /// Appends what it sees.
    pub seen: &'a (dyn Fn(usize, &mut Vec<f32>) + Sync),
    /// Appends what it is to say.
    pub said: &'a (dyn Fn(usize, &mut Vec<f32>) + Sync),
}

/// Share of the first step size that is left at the end.
const LAST_RATE: f64 = 0.01;

/// The mean over the last updates counts, not the last one: what is fitted is noisy.
const AVERAGE_RATE: f64 = 1e-3;

/// Fits a network to all transitions, `mean (net(seen) - said)^2`, and returns the average of its weights over the last
/// updates.
///
/// # Errors
/// When the loss is not finite, or somebody asks to stop.
pub(super) fn fit(
    fitting: &Fitting,
    rows: &Rows<'_>,
    seed: Seed,
    backend: Backend,
    progress: &Progress,
) -> Result<Mlp, LearnError> {
    let shape = MlpShape::new(
        rows.inputs,
        &fitting.hidden,
        rows.outputs,
        Activation::Linear,
    );
    let mut rngs = [seed.child("weights").rng()];
    let mut network = Mlp::new(&shape, Initialiser::UniformFanIn, &mut rngs, backend);
    let mut average = network.clone();
    let mut adam = AdamState::new(&network);
    let rate = WarmupCosine {
        start: fitting.learning_rate,
        peak: fitting.learning_rate,
        end: fitting.learning_rate * LAST_RATE,
        warmup: 0.0,
    };
    let (stream, device, batch) = (seed.child("batch"), backend.device(), fitting.batch);
    for step in 0..fitting.steps {
        let mut rng = stream.rng_at(step);
        let (mut x, mut y) = (Vec::new(), Vec::new());
        for _ in 0..batch {
            let row = rng.random_range(0..rows.count);
            (rows.seen)(row, &mut x);
            (rows.said)(row, &mut y);
        }
        backend.run(|| {
            let x = Tensor::from_data(TensorData::new(x, [1, batch, rows.inputs]), &device);
            let y: Tensor<3> =
                Tensor::from_data(TensorData::new(y, [1, batch, rows.outputs]), &device);
            let (said, tape) = network.forward_tape(x);
            let d = (said - y).mul_scalar(2.0 / (batch * rows.outputs) as f64);
            let gradients = network.gradients(tape, d);
            let rate = rate.rate(step, fitting.steps);
            (fitting.adam).step(&mut network, &mut adam, gradients, rate, step + 1);
            average.polyak(&network, average_share(AVERAGE_RATE, step + 1));
        });
        progress.advance(1);
        if interrupt::requested() {
            return Err(LearnError::Interrupted);
        }
    }
    let first = answers(&average, rows, 0..batch.min(rows.count), backend);
    if first.iter().all(|y| y.is_finite()) {
        Ok(average)
    } else {
        Err(LearnError::Diverged {
            after: format!("{} steps of fitting a network", fitting.steps),
        })
    }
}

/// What a network says of these transitions, row after row.
pub(super) fn answers(
    network: &Mlp,
    rows: &Rows<'_>,
    range: std::ops::Range<usize>,
    backend: Backend,
) -> Vec<f32> {
    /// Rows in one forward pass: large enough to be efficient, small enough to stay in cache.
    const CHUNK: usize = 2048;
    let device = backend.device();
    let mut said = Vec::with_capacity(range.len() * rows.outputs);
    let mut first = range.start;
    while first < range.end {
        let count = CHUNK.min(range.end - first);
        let mut x = Vec::with_capacity(count * rows.inputs);
        (first..first + count).for_each(|row| (rows.seen)(row, &mut x));
        let y = backend.run(|| {
            let x = Tensor::from_data(TensorData::new(x, [1, count, rows.inputs]), &device);
            network.forward(x)
        });
        let y: Vec<f32> = y
            .into_data()
            .try_to_vec()
            .expect("a float tensor holds f32");
        said.extend(y);
        first += count;
    }
    said
}
