//! Choosing the query on which the ensemble disagrees most.

use rand::{Rng, RngExt};

use crate::dataset::{Dataset, Segment, SegmentSampler};
use crate::preferences::{QueryStrategy, RandomPair, Untold};

use super::ensemble::Ensemble;

/// The pair with the largest p (1 - p) among `pool` random ones, p being the share of members that prefer the second
/// segment. With few members many pairs tie; one of them is drawn from the same stream.
pub struct MostDisputed<'a> {
    /// Whose members disagree.
    pub ensemble: &'a Ensemble,
    /// What the segments are of.
    pub dataset: &'a Dataset,
    /// Random pairs among which it is looked for; at least 1.
    pub pool: usize,
}

impl QueryStrategy for MostDisputed<'_> {
    fn choose(
        &self,
        sampler: &SegmentSampler,
        untold: Untold<'_>,
        mut rng: &mut dyn Rng,
    ) -> Option<[Segment; 2]> {
        let pairs: Vec<[Segment; 2]> = (0..self.pool)
            .map(|_| RandomPair.choose(sampler, untold, rng))
            .collect::<Option<_>>()?;
        let returns = self
            .ensemble
            .segment_returns(self.dataset, pairs.as_flattened());
        let members = returns.len();
        // p (1 - p) in units of 1 / members^2, so that ties are exact.
        let dispute = |pair: usize| {
            let prefer_second = returns
                .iter()
                .filter(|r| r[2 * pair + 1] > r[2 * pair])
                .count();
            prefer_second * (members - prefer_second)
        };
        let disputes: Vec<usize> = (0..self.pool).map(dispute).collect();
        let most = disputes.iter().copied().max().unwrap_or(0);
        let tied: Vec<usize> = (0..self.pool).filter(|&i| disputes[i] == most).collect();
        Some(pairs[tied[(&mut rng).random_range(0..tied.len())]])
    }
}
