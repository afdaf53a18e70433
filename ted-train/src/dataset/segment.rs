//! Segments: runs of consecutive steps inside one episode, by construction.

use super::{Clip, Dataset};
use rand::{Rng, RngExt};
use std::ops::Range;

/// `len` consecutive steps of one episode; a value of this type cannot cross an episode end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Segment {
    episode: u32,
    start: u32,
    len: u32,
}

/// Why a segment does not exist.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SegmentError {
    /// The dataset has no such episode.
    #[error("no episode {episode}: the dataset has {episodes}")]
    NoSuchEpisode {
        /// The episode asked for.
        episode: u32,
        /// How many there are.
        episodes: usize,
    },
    /// The steps would run past the end of the episode.
    #[error("steps {start} to {end} of episode {episode} run past its end: it has {len} steps")]
    PastTheEnd {
        /// The episode asked for.
        episode: u32,
        /// First step asked for.
        start: u32,
        /// One past the last step asked for.
        end: u64,
        /// Steps the episode has.
        len: usize,
    },
    /// A segment without steps.
    #[error("a segment needs at least one step")]
    Empty,
    /// Whole episodes where segments must be as long as each other.
    #[error(
        "episodes have {shortest} to {longest} steps, and this reward compares segments of one length only; \
         ask for a number of steps"
    )]
    Unequal {
        /// Steps of the shortest.
        shortest: u32,
        /// Steps of the longest.
        longest: u32,
    },
    /// No episode can hold one segment.
    #[error(
        "no episode has the {segment} steps of a segment: the longest has {longest}; ask for shorter segments"
    )]
    AllTooShort {
        /// Steps of the longest.
        longest: usize,
        /// Steps a segment needs.
        segment: u32,
    },
}

impl Segment {
    /// `len` steps of `episode` from its step `start` on.
    pub fn new(
        dataset: &Dataset,
        episode: u32,
        start: u32,
        len: u32,
    ) -> Result<Self, SegmentError> {
        let episodes = dataset.episodes();
        let Some(found) = episodes.get(episode as usize) else {
            return Err(SegmentError::NoSuchEpisode {
                episode,
                episodes: episodes.len(),
            });
        };
        let end = u64::from(start) + u64::from(len);
        if len == 0 {
            Err(SegmentError::Empty)
        } else if end > found.len as u64 {
            Err(SegmentError::PastTheEnd {
                episode,
                start,
                end,
                len: found.len,
            })
        } else {
            Ok(Self {
                episode,
                start,
                len,
            })
        }
    }

    /// The episode it lies in.
    #[must_use]
    pub fn episode(&self) -> u32 {
        self.episode
    }

    /// Its first step, counted inside the episode.
    #[must_use]
    pub fn start(&self) -> u32 {
        self.start
    }

    /// Its number of steps.
    #[must_use]
    #[allow(clippy::len_without_is_empty, reason = "a segment is never empty")]
    pub fn len(&self) -> u32 {
        self.len
    }

    /// Its steps as indices into the arrays of `dataset`, which must be the one it was made for.
    #[must_use]
    pub fn steps(&self, dataset: &Dataset) -> Range<usize> {
        let first = dataset.episodes()[self.episode as usize].first_step + self.start as usize;
        first..first + self.len as usize
    }

    /// Sum of the true rewards over its steps.
    #[must_use]
    pub fn return_true(&self, dataset: &Dataset) -> f64 {
        dataset.rewards_true()[self.steps(dataset)]
            .iter()
            .map(|&reward| f64::from(reward))
            .sum()
    }
}

/// Draws segments of one kind, uniformly over all valid (episode, start). An episode that is shorter than a segment has none.
#[derive(Clone, Debug)]
pub struct SegmentSampler {
    /// Steps of a segment of each episode.
    lens: Vec<u32>,
    /// For every episode, how many starts there are in it and all before it.
    starts_up_to: Vec<u64>,
}

impl SegmentSampler {
    /// A sampler for such segments.
    ///
    /// # Errors
    /// When every episode has fewer steps, or a segment would have none.
    pub fn new(dataset: &Dataset, clip: Clip) -> Result<Self, SegmentError> {
        let mut starts = 0;
        let each = dataset.episodes().iter().map(|episode| {
            let len = match clip {
                Clip::Steps(0) => return Err(SegmentError::Empty),
                Clip::Steps(steps) => steps,
                // No dataset has more than 2^32 observations: `dataset::assemble` refuses it.
                Clip::Episode => episode.len as u32,
            };
            let last_start = (episode.len as u64).checked_sub(u64::from(len));
            starts += last_start.map_or(0, |last| last + 1);
            Ok((len, starts))
        });
        let (lens, starts_up_to) = each.collect::<Result<_, _>>()?;
        match clip {
            Clip::Steps(segment) if starts == 0 => Err(SegmentError::AllTooShort {
                longest: dataset
                    .episodes()
                    .iter()
                    .map(|it| it.len)
                    .max()
                    .unwrap_or(0),
                segment,
            }),
            _ => Ok(Self { lens, starts_up_to }),
        }
    }

    /// The same for a model that compares only segments as long as each other.
    ///
    /// # Errors
    /// When [`Self::new`] does, or segments would have different lengths.
    pub fn of_one_length(dataset: &Dataset, clip: Clip) -> Result<Self, SegmentError> {
        let sampler = Self::new(dataset, clip)?;
        let lens = || sampler.lens.iter().copied();
        match (lens().min(), lens().max()) {
            (Some(shortest), Some(longest)) if shortest != longest => {
                Err(SegmentError::Unequal { shortest, longest })
            }
            _ => Ok(sampler),
        }
    }

    /// How many segments there are to draw from.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.starts_up_to.last().copied().unwrap_or(0)
    }

    /// One segment.
    pub fn sample(&self, rng: &mut impl Rng) -> Segment {
        self.nth(rng.random_range(0..self.count()))
    }

    fn nth(&self, index: u64) -> Segment {
        let episode = self.starts_up_to.partition_point(|&up_to| up_to <= index);
        let before = episode
            .checked_sub(1)
            .map_or(0, |previous| self.starts_up_to[previous]);
        Segment {
            episode: episode as u32,
            start: (index - before) as u32,
            len: self.lens[episode],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{SHAPE, records};
    use super::*;
    use crate::rng::Seed;

    fn dataset(lengths: &[usize]) -> Dataset {
        Dataset::from_records("ted/x-v0", SHAPE, &records(lengths)).unwrap()
    }

    #[test]
    fn a_segment_cannot_cross_an_episode_end() {
        let dataset = dataset(&[10, 12]);
        assert_eq!(
            Segment::new(&dataset, 1, 2, 10).unwrap().steps(&dataset),
            12..22
        );
        let error = Segment::new(&dataset, 0, 1, 10).unwrap_err();
        assert_eq!(
            error,
            SegmentError::PastTheEnd {
                episode: 0,
                start: 1,
                end: 11,
                len: 10
            }
        );
        assert_eq!(
            Segment::new(&dataset, 2, 0, 1),
            Err(SegmentError::NoSuchEpisode {
                episode: 2,
                episodes: 2
            })
        );
        assert_eq!(Segment::new(&dataset, 0, 3, 0), Err(SegmentError::Empty));
        assert!(Segment::new(&dataset, 0, u32::MAX, u32::MAX).is_err());
    }

    #[test]
    fn every_valid_segment_is_numbered_once() {
        let dataset = dataset(&[5, 9, 5]);
        let sampler = SegmentSampler::new(&dataset, Clip::Steps(5)).unwrap();
        assert_eq!(sampler.count(), 7);
        let all: Vec<_> = (0..7)
            .map(|index| sampler.nth(index))
            .map(|s| (s.episode, s.start))
            .collect();
        assert_eq!(
            all,
            [(0, 0), (1, 0), (1, 1), (1, 2), (1, 3), (1, 4), (2, 0)]
        );
    }

    #[test]
    fn draws_are_uniform_over_starts_and_not_over_episodes() {
        let dataset = dataset(&[5, 9, 5]);
        let sampler = SegmentSampler::new(&dataset, Clip::Steps(5)).unwrap();
        let mut rng = Seed::root(1).rng();
        let in_the_long_one = (0..7_000)
            .filter(|_| sampler.sample(&mut rng).episode() == 1)
            .count();
        assert!(
            (4_850..5_150).contains(&in_the_long_one),
            "{in_the_long_one} of 7000, expected about 5000"
        );
    }

    #[test]
    fn an_episode_shorter_than_a_segment_has_none_and_logs_of_such_episodes_are_refused() {
        let some = dataset(&[3, 6, 4, 5]);
        let sampler = SegmentSampler::new(&some, Clip::Steps(5)).unwrap();
        let all: Vec<_> = (0..sampler.count())
            .map(|index| sampler.nth(index))
            .map(|it| it.steps(&some))
            .collect();
        assert_eq!(all, [3..8, 4..9, 13..18]);
        let error = SegmentSampler::new(&dataset(&[4, 3]), Clip::Steps(5)).unwrap_err();
        let (longest, segment) = (4, 5);
        assert_eq!(error, SegmentError::AllTooShort { longest, segment });
    }

    #[test]
    fn whole_episodes_are_drawn_evenly_however_long_they_are() {
        let dataset = dataset(&[5, 9, 1]);
        let sampler = SegmentSampler::new(&dataset, Clip::Episode).unwrap();
        assert_eq!(sampler.count(), 3);
        let all: Vec<_> = (0..3)
            .map(|index| sampler.nth(index).steps(&dataset))
            .collect();
        assert_eq!(all, [0..5, 5..14, 14..15]);
        let mut rng = Seed::root(1).rng();
        let shortest = (0..3_000)
            .filter(|_| sampler.sample(&mut rng).len() == 1)
            .count();
        assert!((900..1_100).contains(&shortest), "{shortest} of 3000");
    }

    #[test]
    fn whole_episodes_of_different_lengths_are_refused_where_lengths_must_be_equal() {
        let of =
            |lengths: &[usize]| SegmentSampler::of_one_length(&dataset(lengths), Clip::Episode);
        assert_eq!(of(&[4, 4]).unwrap().count(), 2);
        let (shortest, longest) = (3, 9);
        let refused = of(&[5, 9, 3]).unwrap_err();
        assert_eq!(refused, SegmentError::Unequal { shortest, longest });
        let steps = SegmentSampler::of_one_length(&dataset(&[5, 9]), Clip::Steps(5));
        assert_eq!(steps.unwrap().count(), 6);
    }

    #[test]
    fn the_return_of_a_segment_is_the_sum_over_its_steps() {
        let dataset = dataset(&[10, 12]);
        let segment = Segment::new(&dataset, 1, 3, 4).unwrap();
        let expected: f64 = dataset.rewards_true()[13..17]
            .iter()
            .map(|&r| f64::from(r))
            .sum();
        assert_eq!(segment.return_true(&dataset), expected);
    }
}
