//! Choosing the query on which the ensemble disagrees most.

use rand::{Rng, RngExt};

use crate::dataset::{Dataset, Segment, SegmentSampler};

use super::ensemble::Ensemble;

/// A random pair of segments; two different ones whenever the dataset has two.
pub fn random_pair(sampler: &SegmentSampler, rng: &mut impl Rng) -> [Segment; 2] {
    loop {
        let pair = [sampler.sample(rng), sampler.sample(rng)];
        if pair[0] != pair[1] || sampler.count() < 2 {
            return pair;
        }
    }
}

/// The pair with the largest p (1 - p) among `pool` random ones, p being the share of members that prefer the second
/// segment. With few members many pairs tie; one of them is drawn from the same stream.
pub fn most_disputed(
    ensemble: &Ensemble,
    dataset: &Dataset,
    sampler: &SegmentSampler,
    pool: usize,
    rng: &mut impl Rng,
) -> [Segment; 2] {
    let pairs: Vec<[Segment; 2]> = (0..pool).map(|_| random_pair(sampler, rng)).collect();
    let returns = ensemble.segment_returns(dataset, pairs.as_flattened());
    let members = returns.len();
    // p (1 - p) in units of 1 / members^2, so that ties are exact.
    let dispute = |pair: usize| {
        let prefer_second = returns
            .iter()
            .filter(|r| r[2 * pair + 1] > r[2 * pair])
            .count();
        prefer_second * (members - prefer_second)
    };
    let disputes: Vec<usize> = (0..pool).map(dispute).collect();
    let most = disputes.iter().copied().max().unwrap_or(0);
    let tied: Vec<usize> = (0..pool).filter(|&i| disputes[i] == most).collect();
    pairs[tied[rng.random_range(0..tied.len())]]
}
