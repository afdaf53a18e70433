//! What is asked next.

use rand::Rng;

use crate::dataset::{Segment, SegmentSampler};

/// A way to choose the pair of segments that somebody is asked about.
pub trait QueryStrategy {
    /// The next pair, drawn from the sampler's segments with nothing random but `rng`.
    fn choose(&self, sampler: &SegmentSampler, rng: &mut dyn Rng) -> [Segment; 2];
}

/// Any pair; two different segments whenever the dataset has two.
#[derive(Clone, Copy, Debug)]
pub struct RandomPair;

impl QueryStrategy for RandomPair {
    fn choose(&self, sampler: &SegmentSampler, mut rng: &mut dyn Rng) -> [Segment; 2] {
        loop {
            let pair = [sampler.sample(&mut rng), sampler.sample(&mut rng)];
            if pair[0] != pair[1] || sampler.count() < 2 {
                return pair;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::fixtures::{SHAPE, records};
    use crate::dataset::{Clip, Dataset};
    use crate::rng::Seed;

    #[test]
    fn two_different_segments_are_asked_about_even_when_there_are_only_two() {
        let dataset = Dataset::from_records("ted/x-v0", SHAPE, &records(&[9, 9])).unwrap();
        let whole = SegmentSampler::new(&dataset, Clip::Episode).unwrap();
        let mut rng = Seed::root(0).rng();
        for _ in 0..100 {
            let [first, second] = RandomPair.choose(&whole, &mut rng);
            assert_ne!(first, second);
        }
    }
}
