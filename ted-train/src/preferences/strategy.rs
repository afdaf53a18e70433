//! What is asked next.

use rand::Rng;

use super::Untold;
use crate::dataset::{Segment, SegmentSampler};

/// A way to choose the pair of segments that somebody is asked about.
pub trait QueryStrategy {
    /// The next pair, drawn from the sampler's segments with nothing random but `rng`, and none of those that nobody could tell
    /// apart. None when no other pair is found.
    fn choose(
        &self,
        sampler: &SegmentSampler,
        untold: Untold<'_>,
        rng: &mut dyn Rng,
    ) -> Option<[Segment; 2]>;

    /// Why it chose this pair, in words; none where one pair is as good as another.
    fn why(&self, _: [Segment; 2]) -> Option<String> {
        None
    }
}

/// Any pair; two different segments whenever the dataset has two.
#[derive(Clone, Copy, Debug)]
pub struct RandomPair;

impl RandomPair {
    /// Such a pair, whoever was asked about it before.
    pub fn draw(self, sampler: &SegmentSampler, mut rng: &mut dyn Rng) -> [Segment; 2] {
        loop {
            let pair = [sampler.sample(&mut rng), sampler.sample(&mut rng)];
            if pair[0] != pair[1] || sampler.count() < 2 {
                return pair;
            }
        }
    }
}

impl QueryStrategy for RandomPair {
    fn choose(
        &self,
        sampler: &SegmentSampler,
        untold: Untold<'_>,
        rng: &mut dyn Rng,
    ) -> Option<[Segment; 2]> {
        /// Draws after which there is held to be no other pair. Where one of a thousand pairs is left, it is missed less than
        /// once in ten thousand times.
        const DRAWS: usize = 10_000;
        let mut draws = (0..DRAWS).map(|_| self.draw(sampler, rng));
        draws.find(|&pair| !untold.contains(pair))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::fixtures::{SHAPE, records};
    use crate::dataset::{Clip, Dataset};
    use crate::preferences::{Context, LogEntry, Query, Question, Said};
    use crate::rng::Seed;

    fn sampler(lengths: &[usize]) -> SegmentSampler {
        let dataset = Dataset::from_records("ted/x-v0", SHAPE, &records(lengths)).unwrap();
        SegmentSampler::new(&dataset, Clip::Episode).unwrap()
    }

    #[test]
    fn two_different_segments_are_asked_about_even_when_there_are_only_two() {
        let whole = sampler(&[9, 9]);
        let mut rng = Seed::root(0).rng();
        for _ in 0..100 {
            let [first, second] = RandomPair.draw(&whole, &mut rng);
            assert_ne!(first, second);
        }
    }

    #[test]
    fn no_pair_is_asked_about_again_in_either_order_that_nobody_could_tell_apart() {
        let whole = sampler(&[9, 9, 9]);
        let mut rng = Seed::root(0).rng();
        let mut asked: Vec<LogEntry> = Vec::new();
        while let Some(segments) = RandomPair.choose(&whole, Untold::of(&asked), &mut rng) {
            let context = Context {
                round: 0,
                member: None,
            };
            asked.push(LogEntry {
                question: Question {
                    context,
                    query: Query { segments },
                    why: None,
                },
                said: Said {
                    answer: None,
                    later: false,
                    by: String::new(),
                    at: None,
                },
            });
        }
        let mut pairs: Vec<_> = asked
            .iter()
            .map(|entry| entry.question.query.segments.map(|it| it.episode()))
            .collect();
        pairs.iter_mut().for_each(|pair| pair.sort_unstable());
        pairs.sort_unstable();
        assert_eq!(pairs, [[0, 1], [0, 2], [1, 2]]);
    }
}
