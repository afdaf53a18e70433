//! Which two episodes somebody is asked about next.
//!
//! One of the two is always an episode that may be the best, since the best ones are what a policy will imitate: one of the
//! candidates of a sample of the posterior. The other one is a candidate of another sample, or any episode. Among a pool of such
//! pairs the question is asked whose answer says most about the weights (Houlsby et al. 2011): the entropy of the answer as
//! expected, less its entropy if the weights were known.

use nalgebra::{DMatrix, DVector};
use rand::{Rng, RngExt};

use crate::dataset::{Segment, SegmentSampler};
use crate::preferences::{QueryStrategy, RandomPair};
use crate::ranking::ranking;

use super::EpisodesConfig;
use super::posterior::second_better;

/// A choice by what the samples of a posterior disagree on.
pub(super) struct MostInformative<'a> {
    pub config: &'a EpisodesConfig,
    /// `[episode, descriptor]`.
    pub descriptors: &'a DMatrix<f64>,
    /// `[sample, descriptor]`.
    pub samples: &'a DMatrix<f64>,
    /// Every episode as a whole.
    pub episodes: &'a [Segment],
}

impl QueryStrategy for MostInformative<'_> {
    fn choose(&self, sampler: &SegmentSampler, mut rng: &mut dyn Rng) -> [Segment; 2] {
        let best = self.candidates();
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
        let information: Vec<f64> = pool.iter().map(|&pair| self.information(pair)).collect();
        match ranking(&information).first() {
            Some(&most) => pool[most].map(|episode| self.episodes[episode]),
            None => RandomPair.choose(sampler, &mut rng),
        }
    }
}

impl MostInformative<'_> {
    /// The best episodes of each sample.
    fn candidates(&self) -> Vec<Vec<usize>> {
        let qualities = self.descriptors * self.samples.transpose();
        let best = qualities.column_iter().map(|qualities| {
            let mut best = ranking(qualities.as_slice());
            best.truncate(self.config.candidates);
            best
        });
        best.collect()
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
