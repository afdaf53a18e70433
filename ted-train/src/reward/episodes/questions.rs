//! Which two episodes somebody is asked about next.
//!
//! One of the two is always an episode that may be the best, since the best ones are what a policy will imitate: one of the
//! candidates of a sample of the posterior. The other one is a candidate of another sample, or any episode. Among a pool of such
//! pairs the question is asked whose answer says most about the weights (Houlsby et al. 2011): the entropy of the answer as
//! expected, less its entropy if the weights were known.

use nalgebra::{DMatrix, DVector};
use rand::{Rng, RngExt};

use crate::dataset::{Segment, SegmentSampler};
use crate::preferences::{QueryStrategy, RandomPair, Untold};
use crate::ranking::ranking;

use super::EpisodesConfig;
use super::descriptors::Descriptors;
use super::posterior::second_better;

/// A choice by what the samples of a posterior disagree on.
pub(super) struct MostInformative<'a> {
    config: &'a EpisodesConfig,
    /// `[episode, descriptor]`.
    descriptors: &'a DMatrix<f64>,
    /// `[sample, descriptor]`.
    samples: &'a DMatrix<f64>,
    /// Every episode as a whole.
    episodes: &'a [Segment],
    /// The best episodes of each sample.
    best: Vec<Vec<usize>>,
}

impl<'a> MostInformative<'a> {
    /// A choice among these episodes, described by the rows of `descriptors`, with the rows of `samples` as their weights.
    pub fn new(
        config: &'a EpisodesConfig,
        descriptors: &'a DMatrix<f64>,
        samples: &'a DMatrix<f64>,
        episodes: &'a [Segment],
    ) -> Self {
        let qualities = descriptors * samples.transpose();
        let best = qualities.column_iter().map(|qualities| {
            let mut best = ranking(qualities.as_slice());
            best.truncate(config.candidates);
            best
        });
        Self {
            best: best.collect(),
            config,
            descriptors,
            samples,
            episodes,
        }
    }
}

impl QueryStrategy for MostInformative<'_> {
    fn choose(
        &self,
        sampler: &SegmentSampler,
        untold: Untold<'_>,
        rng: &mut dyn Rng,
    ) -> Option<[Segment; 2]> {
        let best = &self.best;
        let count = self.episodes.len();
        let mut pool = Vec::with_capacity(self.config.pool);
        for _ in 0..self.config.pool {
            let mut candidate = || {
                let of_sample = &best[rng.random_range(0..best.len())];
                of_sample[rng.random_range(0..of_sample.len())]
            };
            let first = candidate();
            let another = candidate();
            let any = rng.random_range(0..count);
            let second = if rng.random::<bool>() { another } else { any };
            let swap = rng.random::<bool>();
            if first != second {
                pool.push(if swap {
                    [second, first]
                } else {
                    [first, second]
                });
            }
        }
        // Who answered a question would say the same again; the model, which allows for slips, would like to hear it twice.
        pool.retain(|pair| {
            let pair = pair.map(|episode| self.episodes[episode]);
            !untold.contains(pair) && !untold.is_told(pair)
        });
        let information: Vec<f64> = pool.iter().map(|&pair| self.information(pair)).collect();
        match ranking(&information).first() {
            Some(&most) => Some(pool[most].map(|episode| self.episodes[episode])),
            None => self
                .any_new(sampler, untold, rng)
                .or_else(|| RandomPair.choose(sampler, untold, rng)),
        }
    }

    fn why(&self, segments: [Segment; 2]) -> Option<String> {
        let [first, second] = segments.map(|segment| segment.episode() as usize);
        let best = |episode| self.best.iter().any(|best| best.contains(&episode));
        let may = match (best(first), best(second)) {
            (true, true) => "both may be among the best",
            (true, false) => "the first may be among the best",
            (false, true) => "the second may be among the best",
            // Drawn at random, where no such pair was left.
            (false, false) => return None,
        };
        let about = match self.most_open([first, second]) {
            Some(descriptor) => {
                let name = Descriptors::name(descriptor);
                format!(", and the answer says most about how far {name} counts")
            }
            None => String::new(),
        };
        Some(format!("{may}{about}"))
    }
}

impl MostInformative<'_> {
    /// Any pair that nobody was asked about, where it is found among as many as the pool has.
    fn any_new(
        &self,
        sampler: &SegmentSampler,
        untold: Untold<'_>,
        rng: &mut dyn Rng,
    ) -> Option<[Segment; 2]> {
        let mut draws = (0..self.config.pool).map(|_| RandomPair.draw(sampler, rng));
        draws.find(|&pair| !untold.contains(pair) && !untold.is_told(pair))
    }

    /// The descriptor whose part in the difference between two episodes the samples agree on least; none if they agree on all.
    fn most_open(&self, [first, second]: [usize; 2]) -> Option<usize> {
        let parts = self.samples.column_iter().enumerate().map(|(j, weights)| {
            let apart = self.descriptors[(second, j)] - self.descriptors[(first, j)];
            (j, weights.variance().sqrt() * apart.abs())
        });
        let most = parts.max_by(|(_, one), (_, other)| one.total_cmp(other))?;
        (most.1 > 0.0).then_some(most.0)
    }

    /// What an answer would say about the weights, in nats.
    fn information(&self, [first, second]: [usize; 2]) -> f64 {
        let difference = self.descriptors.row(second) - self.descriptors.row(first);
        let differences: DVector<f64> = self.samples * difference.transpose();
        let (mut mean, mut known) = (0.0, 0.0);
        for &difference in differences.iter() {
            let p = second_better(self.config, difference);
            mean += p;
            known += entropy(p);
        }
        let count = differences.len() as f64;
        entropy(mean / count) - known / count
    }
}

fn entropy(p: f64) -> f64 {
    -(p * p.ln() + (1.0 - p) * (1.0 - p).ln())
}
