//! A look at the logs before anybody is asked: what can be said of each episode without a label, and how far to trust it.
//!
//! *Competence* is how far an episode's actions go the way that the average of all episodes goes in the same places, where that
//! goes anywhere: noise without a preferred direction cancels in the average, and a shared purpose does not. *Whereabouts* are the principal
//! directions of an episode's mean features of observations, as far as its first observation does not say them already. They are
//! those in which good episodes differ: the most competent tenth counts for as much as all episodes together, as far as competence
//! is reliable.
//!
//! Each is computed on two halves of an episode, made of every other block of steps. What two halves of the same episode do not
//! agree on is noise: their correlation over episodes, corrected for the length (Spearman and Brown), is the descriptor's
//! reliability, and what is believed of it beforehand is believed in that proportion.

use nalgebra::{DMatrix, DVector};

use crate::dataset::{Dataset, Episode};
use crate::ranking::ranking;
use crate::rng::Seed;

use super::EpisodesConfig;
use super::features::Features;

/// Numbers of each episode, standardised over episodes, and what they are made of.
#[derive(Clone, Debug)]
pub struct Descriptors {
    /// `[episode, descriptor]`: competence, then one whereabouts after the other, each with mean 0 and standard deviation 1 over
    /// episodes, of whereabouts with the weight that each episode has, and 0 where it is the same for all.
    pub values: DMatrix<f64>,
    /// How far the two halves of an episode agree on each, from 0 to 1.
    pub reliability: Vec<f64>,
    /// Mean competence and its deviation.
    competence: [f64; 2],
    features: Features,
    /// `[feature, direction]`: the directions of whereabouts, divided by the deviation of each.
    directions: DMatrix<f64>,
    /// `[episode, direction]`: what the first observation says of whereabouts, and the mean: subtracted.
    offsets: DMatrix<f64>,
    /// `[channel, direction]`: correlation of whereabouts with the mean of each channel beyond what the beginning says.
    channels: DMatrix<f64>,
}

/// Competence of single steps, and the channels of observations in units of their own deviation.
pub(super) struct Steps<'a> {
    pub dataset: &'a Dataset,
    /// `a . f(s)` and `|f(s)|` of each step.
    pub along: Vec<[f64; 2]>,
    /// Mean of each channel, and the inverse of its deviation; 0 for a channel that does not move.
    pub shift: Vec<f32>,
    pub scale: Vec<f32>,
}

impl<'a> Steps<'a> {
    /// From what the clone does in each step, `steps x action`.
    pub fn new(dataset: &'a Dataset, cloned: &[f32]) -> Self {
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
        f64::from((observation[channel] - self.shift[channel]) * self.scale[channel])
    }

    /// The same of all channels in all steps of an episode, `[channel, step]`.
    fn channels(&self, episode: &Episode) -> DMatrix<f32> {
        DMatrix::from_fn(self.dataset.observation_dim(), episode.len, |c, step| {
            let observation = self.dataset.observation(episode.first_step + step);
            self.channel(observation, c) as f32
        })
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
    pub(super) fn of(steps: &Steps<'_>, config: &EpisodesConfig, seed: Seed) -> Self {
        let moving = steps.scale.iter().filter(|&&scale| scale > 0.0).count();
        let features = Features::new(
            config.features,
            config.frequency,
            steps.scale.len(),
            moving,
            seed,
        );
        let means = Means::of(steps, &features, config.block);
        let [whole, even, odd] = &means;

        let competences = whole.competence.column(0);
        let competence = [competences.mean(), deviation(&competences)];
        let competent = |means: &Means| {
            let [mean, std] = competence;
            let scale = if std > TINY { 1.0 / std } else { 0.0 };
            means.competence.map(|c| (c - mean) * scale)
        };
        let trusted = reliability(&competent(even).column(0), &competent(odd).column(0));
        let weights = weights(&competences, trusted);

        // Whereabouts beyond what the beginning says.
        let first = beginnings(steps);
        let expected = &first * regress(&first, &whole.features);
        let residual = centred(&whole.features - &expected, &weights);
        let basis = principal(&residual, &weights, config.directions);
        let projected = &residual * &basis;
        let squares = projected.map(|x| x * x).transpose() * &weights;
        let deviations = squares.map(f64::sqrt);
        // What is left of a feature that the beginning decides is rounding, and a direction of it says nothing.
        let least = TINY.max(ROUNDING * deviations.iter().copied().fold(0.0, f64::max));
        let mut directions = basis;
        for (mut direction, &deviation) in directions.column_iter_mut().zip(deviations.iter()) {
            direction *= if deviation > least {
                1.0 / deviation
            } else {
                0.0
            };
        }
        let mut offsets = expected * &directions;
        let means_of_rest = (&whole.features * &directions - &offsets).transpose() * &weights;
        for mut row in offsets.row_iter_mut() {
            row += means_of_rest.transpose();
        }

        let describe = |means: &Means| {
            let whereabouts = &means.features * &directions - &offsets;
            let mut all = whereabouts.insert_column(0, 0.0);
            all.set_column(0, &competent(means).column(0));
            all
        };
        let [values, even, odd] = means.each_ref().map(describe);
        let halves = even.column_iter().zip(odd.column_iter());
        let channels = &whole.channels - &first * regress(&first, &whole.channels);
        Self {
            reliability: halves.map(|(even, odd)| reliability(&even, &odd)).collect(),
            channels: DMatrix::from_fn(channels.ncols(), directions.ncols(), |c, j| {
                correlation(&channels.column(c), &values.column(1 + j))
            }),
            values,
            competence,
            features,
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

    /// The channels that go with a direction of whereabouts, each with its correlation, the largest first.
    #[must_use]
    pub fn channels(&self, direction: usize) -> Vec<(usize, f64)> {
        let column = self.channels.column(direction);
        let mut correlations: Vec<_> = column.iter().copied().enumerate().collect();
        correlations.retain(|(_, correlation)| *correlation != 0.0);
        correlations.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
        correlations
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
        let competence = if std > TINY { weights[0] / std } else { 0.0 };
        let weights = weights.rows(1, weights.len() - 1);
        let direction = &self.directions * weights;
        let offsets = &self.offsets * weights;
        let mut shares = Vec::with_capacity(steps.dataset.step_count());
        for (episode, &offset) in steps.dataset.episodes().iter().zip(offsets.iter()) {
            let range = episode.first_step..episode.first_step + episode.len;
            let length = steps.mean_length(range.clone());
            let features = self.features.of(&steps.channels(episode));
            for (step, features) in range.zip(features.column_iter()) {
                let along = steps.along[step][0] / length;
                let parts = direction.iter().zip(features.iter());
                let place: f64 = parts.map(|(d, &x)| d * f64::from(x)).sum();
                shares.push((competence * (along - mean) + place - offset) as f32);
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
    /// `[episode, feature]`.
    features: DMatrix<f64>,
}

impl Means {
    /// Over all steps, and over those of every other block, first the even and then the odd ones; over all steps again of an
    /// episode that has none of them.
    fn of(steps: &Steps<'_>, features: &Features, block: usize) -> [Self; 3] {
        let episodes = steps.dataset.episodes();
        let (width, count) = (steps.dataset.observation_dim(), features.count());
        let mut means = [(); 3].map(|()| Self {
            competence: DMatrix::zeros(episodes.len(), 1),
            channels: DMatrix::zeros(episodes.len(), width),
            features: DMatrix::zeros(episodes.len(), count),
        });
        for (row, episode) in episodes.iter().enumerate() {
            let channels = steps.channels(episode);
            let of_steps = features.of(&channels);
            let in_part = |part: usize, step: usize| part == 0 || step / block % 2 == part - 1;
            for (part, means) in means.iter_mut().enumerate() {
                let any = (0..episode.len).any(|step| in_part(part, step));
                let (mut total, mut along, mut length) = (0.0, 0.0, 0.0);
                for step in (0..episode.len).filter(|&step| !any || in_part(part, step)) {
                    let [dot, norm] = steps.along[episode.first_step + step];
                    along += dot;
                    length += norm;
                    for (sum, &x) in means
                        .channels
                        .row_mut(row)
                        .iter_mut()
                        .zip(&channels.column(step))
                    {
                        *sum += f64::from(x);
                    }
                    for (sum, &x) in means
                        .features
                        .row_mut(row)
                        .iter_mut()
                        .zip(&of_steps.column(step))
                    {
                        *sum += f64::from(x);
                    }
                    total += 1.0;
                }
                means.competence[(row, 0)] = along / length.max(STILL * total);
                means.channels.row_mut(row).unscale_mut(total);
                means.features.row_mut(row).unscale_mut(total);
            }
        }
        means
    }
}

/// How much each episode counts for whereabouts, all together 1: the most competent `LIKELY` of them for `trusted / 2`, and all of them for the rest.
pub(super) fn weights(competence: &Column<'_>, trusted: f64) -> DVector<f64> {
    /// Share of the episodes that are likely to hold the best.
    const LIKELY: f64 = 0.1;
    let values: Vec<f64> = competence.iter().copied().collect();
    let count = values.len() as f64;
    let likely = (LIKELY * count).ceil();
    let mut weights = DVector::from_element(values.len(), (1.0 - trusted / 2.0) / count);
    for episode in ranking(&values).into_iter().take(likely as usize) {
        weights[episode] += trusted / 2.0 / likely;
    }
    weights
}

/// Rows without their mean, in which each counts by its weight.
fn centred(mut rows: DMatrix<f64>, weights: &DVector<f64>) -> DMatrix<f64> {
    let mean = (rows.transpose() * weights).transpose();
    for mut row in rows.row_iter_mut() {
        row -= &mean;
    }
    rows
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

/// The directions in which rows vary most, each counting by its weight, `[column, count]`, each with its largest entry positive.
fn principal(rows: &DMatrix<f64>, weights: &DVector<f64>, count: usize) -> DMatrix<f64> {
    let mut weighted = rows.clone();
    for (mut row, &weight) in weighted.row_iter_mut().zip(weights.iter()) {
        row *= weight;
    }
    let eigen = (rows.transpose() * weighted).symmetric_eigen();
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

/// What two halves that agree so far say of the whole, from 0 to 1 (Spearman and Brown).
fn reliability(even: &Column<'_>, odd: &Column<'_>) -> f64 {
    let r = correlation(even, odd).max(0.0);
    2.0 * r / (1.0 + r)
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
