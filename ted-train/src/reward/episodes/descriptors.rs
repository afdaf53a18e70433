//! A look at the logs before anybody is asked: what can be said of each episode without a label, and how far to trust it.
//!
//! *Competence* is how far an episode's actions go the way that the average of all episodes goes in the same places, where that
//! goes anywhere: noise without a preferred direction cancels in the average, and a shared purpose does not. *Whereabouts* are the principal
//! directions of an episode's mean observation, as far as its first observation does not say them already.
//!
//! Each is computed on two halves of an episode, made of every other block of steps. What two halves of the same episode do not
//! agree on is noise: their correlation over episodes, corrected for the length (Spearman and Brown), is the descriptor's
//! reliability, and what is believed of it beforehand is believed in that proportion.
//!
//! A channel that rests in most episodes has a small deviation, and where it moves after all it may be thirty of them away. So
//! channels and descriptors are cut off: else the directions would be those of a few episodes in which something fell over.

use nalgebra::{DMatrix, DVector};

use crate::dataset::Dataset;
use crate::ranking::ranking;

/// Numbers of each episode, standardised over episodes, and what they are made of.
#[derive(Clone, Debug)]
pub struct Descriptors {
    /// `[episode, descriptor]`: competence, then one whereabouts after the other, each with mean 0 and standard deviation 1 over
    /// episodes before it was cut off, and 0 where it is the same for all.
    pub values: DMatrix<f64>,
    /// `[episode, descriptor]`: the share of each that is left after that.
    left: DMatrix<f64>,
    /// How far the two halves of an episode agree on each, from 0 to 1.
    pub reliability: Vec<f64>,
    /// Mean competence and its deviation.
    competence: [f64; 2],
    /// `[channel, direction]`: the directions of whereabouts in standardised channels, divided by the deviation of each.
    directions: DMatrix<f64>,
    /// `[episode, direction]`: what the first observation says of whereabouts, and the mean: subtracted.
    offsets: DMatrix<f64>,
}

/// Competence of single steps, and the channels of observations in units of their own deviation.
pub(super) struct Steps<'a> {
    pub dataset: &'a Dataset,
    /// `a . f(s)` and `|f(s)|` of each step.
    pub along: Vec<[f64; 2]>,
    /// Mean of each channel, and the inverse of its deviation; 0 for a channel that does not move.
    pub shift: Vec<f32>,
    pub scale: Vec<f32>,
    /// Deviations at which a channel is cut off.
    clip: f64,
}

impl<'a> Steps<'a> {
    /// From what the clone does in each step, `steps x action`, and the deviations at which a channel is cut off.
    pub fn new(dataset: &'a Dataset, cloned: &[f32], clip: f64) -> Self {
        let width = dataset.action_dim();
        let rows = dataset.actions().chunks_exact(width);
        let along = rows.zip(cloned.chunks_exact(width)).map(|(a, f)| {
            let dot: f64 = a.iter().zip(f).map(|(&a, &f)| f64::from(a * f)).sum();
            let squares: f64 = f.iter().map(|&f| f64::from(f * f)).sum();
            [dot, squares.sqrt()]
        });
        let [shift, scale] = scaling(dataset);
        Self {
            dataset,
            along: along.collect(),
            shift,
            scale,
            clip,
        }
    }

    /// What the dot product of each step is divided by to have a mean over the episode that is its competence: the mean of `|f|`.
    fn mean_length(&self, steps: std::ops::Range<usize>) -> f64 {
        let total: f64 = self.along[steps.clone()]
            .iter()
            .map(|[_, length]| length)
            .sum();
        (total / steps.len().max(1) as f64).max(STILL)
    }

    /// A channel of a row of observations, in units of its deviation.
    fn channel(&self, observation: &[f32], channel: usize) -> f64 {
        let moved = f64::from((observation[channel] - self.shift[channel]) * self.scale[channel]);
        moved.clamp(-self.clip, self.clip)
    }

    /// The same of all channels.
    pub fn channels(&self, observation: &[f32]) -> DVector<f64> {
        DVector::from_fn(observation.len(), |c, _| self.channel(observation, c))
    }
}

/// Mean of each channel and the inverse of its deviation; 0 where it does not move by more than single precision tells apart.
pub(super) fn scaling(dataset: &Dataset) -> [Vec<f32>; 2] {
    let statistics = dataset.observation_statistics();
    let ends = statistics.min.iter().zip(&statistics.max);
    let scale = statistics.std.iter().zip(ends).map(|(&std, (low, high))| {
        let still = 1e-5 * low.abs().max(high.abs());
        if std > still { 1.0 / std } else { 0.0 }
    });
    let scale = scale.collect();
    [statistics.mean, scale]
}

impl Descriptors {
    /// Describes every episode.
    pub(super) fn of(steps: &Steps<'_>, directions: usize, block: usize) -> Self {
        let dataset = steps.dataset;
        let whole = Means::of(steps, |_| true);
        let halves = [0, 1].map(|half| Means::of(steps, |step| step / block % 2 == half));

        // Whereabouts beyond what the beginning says.
        let first = beginnings(steps);
        let rest = |means: &DMatrix<f64>| means - &first * regress(&first, &whole.channels);
        let residual = rest(&whole.channels);
        let basis = principal(&residual, directions);
        let projected = &residual * &basis;
        let deviations: Vec<f64> = projected.column_iter().map(|c| deviation(&c)).collect();
        // What is left of a channel that the beginning decides is rounding, and a direction of it says nothing.
        let least = TINY.max(ROUNDING * deviations.iter().copied().fold(0.0, f64::max));
        let inverse = |j: usize| {
            if deviations[j] > least {
                1.0 / deviations[j]
            } else {
                0.0
            }
        };
        let directions = DMatrix::from_fn(basis.nrows(), basis.ncols(), |i, j| {
            basis[(i, j)] * inverse(j)
        });
        let offsets = (&first * regress(&first, &whole.channels)) * &directions;

        let (mean, std) = (
            whole.competence.mean(),
            deviation(&whole.competence.column(0)),
        );
        let competence = [mean, std];
        let describe = |means: &Means| {
            let whereabouts = &means.channels * &directions - &offsets;
            let mut all = whereabouts.insert_column(0, 0.0);
            let scale = if std > TINY { 1.0 / std } else { 0.0 };
            all.set_column(0, &means.competence.map(|c| (c - mean) * scale).column(0));
            all
        };
        let raw = describe(&whole);
        let values = raw.map(|x| x.clamp(-steps.clip, steps.clip));
        let left = values.zip_map(&raw, |cut, raw| if cut == raw { 1.0 } else { cut / raw });
        let [even, odd] = halves.each_ref().map(describe);
        let reliability = even.column_iter().zip(odd.column_iter());
        let reliability = reliability.map(|(even, odd)| {
            let r = correlation(&even, &odd).max(0.0);
            2.0 * r / (1.0 + r)
        });
        debug_assert_eq!(values.nrows(), dataset.episodes().len());
        Self {
            reliability: reliability.collect(),
            values,
            left,
            competence,
            directions,
            offsets,
        }
    }

    /// What a descriptor is called: competence, then the whereabouts by their number.
    #[must_use]
    pub fn name(descriptor: usize) -> String {
        match descriptor {
            0 => "competence".to_owned(),
            direction => format!("whereabouts {direction}"),
        }
    }

    /// The channels that a direction of whereabouts is made of, with their weights, the largest first.
    #[must_use]
    pub fn channels(&self, direction: usize) -> Vec<(usize, f64)> {
        let column = self.directions.column(direction);
        let mut weights: Vec<_> = column.iter().copied().enumerate().collect();
        weights.retain(|(_, weight)| *weight != 0.0);
        weights.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
        weights
    }

    /// The episodes that have most of a descriptor, the first the most.
    #[must_use]
    pub fn most(&self, descriptor: usize, count: usize) -> Vec<usize> {
        let column = self.values.column(descriptor);
        let values: Vec<f64> = column.iter().copied().collect();
        let mut most = ranking(&values);
        most.truncate(count);
        most
    }

    /// The share of an episode's quality that each step has, whose mean over the steps of an episode is `weights` times its
    /// descriptors.
    pub(super) fn shares(&self, steps: &Steps<'_>, weights: &DVector<f64>) -> Vec<f32> {
        let [mean, std] = self.competence;
        let scale = if std > TINY { 1.0 / std } else { 0.0 };
        let mut shares = Vec::with_capacity(steps.dataset.step_count());
        for (row, episode) in steps.dataset.episodes().iter().enumerate() {
            let weights = weights.component_mul(&self.left.row(row).transpose());
            let competence = weights[0] * scale;
            let weights = weights.rows(1, weights.len() - 1);
            let direction = &self.directions * weights;
            let offset = (self.offsets.row(row) * weights)[0];
            let range = episode.first_step..episode.first_step + episode.len;
            let length = steps.mean_length(range.clone());
            for step in range {
                let place = steps.channels(steps.dataset.observation(step));
                let along = steps.along[step][0] / length;
                let share = competence * (along - mean) + direction.dot(&place) - offset;
                shares.push(share as f32);
            }
        }
        shares
    }
}

/// Below this the clone does nothing, and nothing goes its way.
const STILL: f64 = 1e-6;

/// Deviations below this are none.
const TINY: f64 = 1e-12;

/// Share of the largest deviation that a direction has at least.
const ROUNDING: f64 = 1e-3;

/// Means over some steps of every episode.
struct Means {
    /// `[episode, 1]`.
    competence: DMatrix<f64>,
    /// `[episode, channel]`.
    channels: DMatrix<f64>,
}

impl Means {
    /// Over the steps that `counts` says yes to; over all steps of an episode that has none of them.
    fn of(steps: &Steps<'_>, counts: impl Fn(usize) -> bool) -> Self {
        let dataset = steps.dataset;
        let (episodes, width) = (dataset.episodes(), dataset.observation_dim());
        let mut competence = DMatrix::zeros(episodes.len(), 1);
        let mut channels = DMatrix::zeros(episodes.len(), width);
        for (row, episode) in episodes.iter().enumerate() {
            let any = (0..episode.len).any(&counts);
            let (mut total, mut along, mut length) = (0.0, 0.0, 0.0);
            for step in (0..episode.len).filter(|&step| !any || counts(step)) {
                let step = episode.first_step + step;
                along += steps.along[step][0];
                length += steps.along[step][1];
                let observation = dataset.observation(step);
                for channel in 0..width {
                    channels[(row, channel)] += steps.channel(observation, channel);
                }
                total += 1.0;
            }
            competence[(row, 0)] = along / length.max(STILL * total);
            channels.row_mut(row).unscale_mut(total);
        }
        Self {
            competence,
            channels,
        }
    }
}

/// `[episode, 1 + channel]`: a one and the first observation of every episode.
fn beginnings(steps: &Steps<'_>) -> DMatrix<f64> {
    let dataset = steps.dataset;
    let (episodes, width) = (dataset.episodes(), dataset.observation_dim());
    DMatrix::from_fn(episodes.len(), 1 + width, |episode, column| {
        let first = dataset.observation(episodes[episode].first_step);
        match column.checked_sub(1) {
            Some(channel) => steps.channel(first, channel),
            None => 1.0,
        }
    })
}

/// Least squares of `y` on `x`, with just enough ridge that what does not move gets no weight.
fn regress(x: &DMatrix<f64>, y: &DMatrix<f64>) -> DMatrix<f64> {
    const RIDGE: f64 = 1e-3;
    let mut normal = x.transpose() * x;
    (0..normal.nrows()).for_each(|i| normal[(i, i)] += RIDGE);
    let right = x.transpose() * y;
    // Positive definite by the ridge.
    normal.cholesky().map_or_else(
        || DMatrix::zeros(x.ncols(), y.ncols()),
        |it| it.solve(&right),
    )
}

/// The directions in which rows vary most, `[column, count]`, each with its largest entry positive.
fn principal(rows: &DMatrix<f64>, count: usize) -> DMatrix<f64> {
    let eigen = (rows.transpose() * rows).symmetric_eigen();
    let mut order: Vec<usize> = (0..eigen.eigenvalues.len()).collect();
    order.sort_by(|&i, &j| eigen.eigenvalues[j].total_cmp(&eigen.eigenvalues[i]));
    order.truncate(count);
    let mut basis = DMatrix::from_fn(rows.ncols(), order.len(), |row, column| {
        eigen.eigenvectors[(row, order[column])]
    });
    for mut column in basis.column_iter_mut() {
        let largest = column.iter().copied().fold(
            0.0,
            |best: f64, x| {
                if x.abs() > best.abs() { x } else { best }
            },
        );
        if largest < 0.0 {
            column.neg_mut();
        }
    }
    basis
}

type Column<'a> = nalgebra::DVectorView<'a, f64>;

fn deviation(column: &Column<'_>) -> f64 {
    let mean = column.mean();
    let squares: f64 = column.iter().map(|x| (x - mean) * (x - mean)).sum();
    (squares / column.len().max(1) as f64).sqrt()
}

/// Pearson's; 0 where one of them does not move.
fn correlation(x: &Column<'_>, y: &Column<'_>) -> f64 {
    let (mean_x, mean_y) = (x.mean(), y.mean());
    let products = x
        .iter()
        .zip(y.iter())
        .map(|(x, y)| (x - mean_x) * (y - mean_y));
    let covariance = products.sum::<f64>() / x.len().max(1) as f64;
    let scale = deviation(x) * deviation(y);
    if scale > TINY {
        covariance / scale
    } else {
        0.0
    }
}
