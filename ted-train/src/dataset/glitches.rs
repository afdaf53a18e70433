//! Glitches: single frames in which a channel is where it never is otherwise, such as a reading of 1e6 from a loose plug.
//!
//! A value is a glitch if it is more than [`FAR`] times the range of its channel away from the median of the frames around it.
//! The range is that of these medians over the whole dataset, so no glitch widens it. Where more values of a channel than one in
//! [`RARE`] would be glitches, they are what the channel does, and none of them is one.
//!
//! What is learned from is the median. As recorded, one frame would decide the scale of its channel, what a guard accepts, and a
//! gradient.

use rayon::prelude::*;
use serde::Serialize;

use super::Episode;

/// Ranges of its channel that a glitch is away from its neighbours.
const FAR: f64 = 10.0;

/// One value in so many may be a glitch, and one at least.
const RARE: usize = 1000;

/// Frames on each side that a value is compared with.
const AROUND: usize = 2;

/// Every so many frames one is looked at to find a range that a channel has at least.
const SAMPLED: usize = 32;

/// A value of an observation that nothing is learned from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Glitch {
    /// The episode.
    pub episode: usize,
    /// The observation inside the episode, from 0: step `t` acted on observation `t`.
    pub step: usize,
    /// The channel.
    pub channel: usize,
    /// As recorded.
    pub value: f32,
    /// The median of the frames around it, which stands in its place.
    pub usual: f32,
}

/// Puts the median of the frames around it in the place of every glitch, and says which there were, in recorded order.
pub(super) fn mend(observations: &mut [f32], width: usize, episodes: &[Episode]) -> Vec<Glitch> {
    let frames = Frames {
        observations,
        width,
        episodes,
    };
    let suspects = frames.suspects();
    let mut glitches: Vec<Glitch> = suspects
        .into_par_iter()
        .flat_map(|channel| frames.glitches(channel))
        .collect();
    glitches.sort_by_key(|it| (it.episode, it.step, it.channel));
    for glitch in &glitches {
        let row = first_row(episodes, glitch.episode) + glitch.step;
        observations[row * width + glitch.channel] = glitch.usual;
    }
    glitches
}

/// The row of an episode's first observation.
fn first_row(episodes: &[Episode], episode: usize) -> usize {
    episodes[episode].first_step + episode
}

struct Frames<'a> {
    observations: &'a [f32],
    width: usize,
    episodes: &'a [Episode],
}

impl Frames<'_> {
    /// Channels that may have a glitch. One whose range is not larger than what is far has none, and its range is at least that of
    /// some of its medians: so of nearly all channels nothing else is looked at.
    fn suspects(&self) -> Vec<usize> {
        let nothing = Range::default();
        let mut raw = vec![nothing; self.width];
        for row in self.observations.chunks_exact(self.width) {
            raw.iter_mut().zip(row).for_each(|(it, &x)| it.take(x));
        }
        let mut usual = vec![nothing; self.width];
        for (episode, step) in self.steps(SAMPLED) {
            for (channel, range) in usual.iter_mut().enumerate() {
                range.take(self.median(episode, step, channel));
            }
        }
        let ranges = raw.iter().zip(&usual).enumerate();
        let suspects = ranges.filter(|(_, (raw, usual))| raw.width() > FAR * usual.width());
        suspects.map(|(channel, _)| channel).collect()
    }

    /// The glitches of a channel, in recorded order.
    fn glitches(&self, channel: usize) -> Vec<Glitch> {
        let usual = |(episode, step)| self.median(episode, step, channel);
        let mut range = Range::default();
        let medians: Vec<f32> = self.steps(1).map(usual).collect();
        medians.iter().for_each(|&it| range.take(it));
        let far = FAR * range.width();
        let glitches = self.steps(1).zip(&medians);
        let glitches = glitches.filter_map(|((episode, step), &usual)| {
            let value = self.value(first_row(self.episodes, episode) + step, channel);
            let glitch = Glitch {
                episode,
                step,
                channel,
                value,
                usual,
            };
            ((f64::from(value) - f64::from(usual)).abs() > far).then_some(glitch)
        });
        let glitches: Vec<_> = glitches.collect();
        match glitches.len() <= (medians.len() / RARE).max(1) {
            true => glitches,
            false => Vec::new(),
        }
    }

    /// Every `every`-th observation of every episode, as episode and step.
    fn steps(&self, every: usize) -> impl Iterator<Item = (usize, usize)> {
        let episodes = self.episodes.iter().enumerate();
        episodes.flat_map(move |(index, it)| (0..=it.len).step_by(every).map(move |t| (index, t)))
    }

    /// The median of a channel over the frames around one, as far as the episode has them; the lower one of an even number.
    fn median(&self, episode: usize, step: usize, channel: usize) -> f32 {
        let first = first_row(self.episodes, episode);
        let last = (step + AROUND).min(self.episodes[episode].len);
        let mut window = [0.0; 2 * AROUND + 1];
        let mut count = 0;
        for at in step.saturating_sub(AROUND)..=last {
            window[count] = self.value(first + at, channel);
            count += 1;
        }
        let window = &mut window[..count];
        window.sort_unstable_by(f32::total_cmp);
        window[(count - 1) / 2]
    }

    fn value(&self, row: usize, channel: usize) -> f32 {
        self.observations[row * self.width + channel]
    }
}

/// The smallest and the largest of some values.
#[derive(Clone, Copy)]
struct Range {
    low: f32,
    high: f32,
}

impl Default for Range {
    fn default() -> Self {
        Self {
            low: f32::INFINITY,
            high: f32::NEG_INFINITY,
        }
    }
}

impl Range {
    fn take(&mut self, value: f32) {
        self.low = self.low.min(value);
        self.high = self.high.max(value);
    }

    fn width(&self) -> f64 {
        f64::from(self.high) - f64::from(self.low)
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{SHAPE, records};
    use crate::dataset::{Dataset, EpisodeRecord};

    fn dataset(records: &[EpisodeRecord]) -> Dataset {
        Dataset::from_records("ted/x-v0", SHAPE, records).unwrap()
    }

    /// Sets one value of an observation.
    fn set(record: &mut EpisodeRecord, step: usize, channel: usize, value: f32) {
        record.observations[step * SHAPE.observation + channel] = value;
    }

    #[test]
    fn a_frame_far_from_its_neighbours_is_a_glitch_at_either_end_of_an_episode_and_between() {
        for step in [0, 1, 3, 29, 30] {
            let clean = records(&[40, 30, 20]);
            let mut broken = clean.clone();
            set(&mut broken[1], step, 2, -1e6);
            let dataset = dataset(&broken);
            let [glitch] = dataset.glitches() else {
                panic!("{:?}", dataset.glitches());
            };
            let place = (glitch.episode, glitch.step, glitch.channel);
            assert_eq!(place, (1, step, 2));
            assert_eq!(glitch.value, -1e6);
            let row = 41 + step;
            let mended = dataset.observations()[row * SHAPE.observation + 2];
            assert_eq!(mended, glitch.usual);
            assert!(mended.abs() <= 1.0, "{mended}");
        }
    }

    #[test]
    fn every_glitch_of_a_long_dataset_is_found_whichever_frames_are_sampled() {
        let mut broken = records(&[1500, 1500]);
        for (episode, step) in [(0, 64), (0, 65), (1, 1000)] {
            set(&mut broken[episode], step, 6, 1e4);
        }
        let glitches = dataset(&broken).glitches().to_vec();
        let places: Vec<_> = glitches.iter().map(|it| (it.episode, it.step)).collect();
        assert_eq!(places, [(0, 64), (0, 65), (1, 1000)]);
    }

    #[test]
    fn what_happens_more_than_once_in_a_thousand_frames_is_what_the_channel_does() {
        let mut broken = records(&[40, 30]);
        set(&mut broken[0], 10, 2, 1e6);
        set(&mut broken[1], 10, 2, 1e6);
        let dataset = dataset(&broken);
        assert_eq!(dataset.glitches(), []);
        assert_eq!(dataset.observation_statistics().max[2], 1e6);
    }

    #[test]
    fn what_stays_is_no_glitch_and_neither_is_what_is_far_by_less_than_ten_ranges() {
        let mut logs = records(&[40, 30]);
        for step in 10..20 {
            set(&mut logs[0], step, 2, 1e6);
        }
        set(&mut logs[1], 10, 3, 9.0);
        assert_eq!(dataset(&logs).glitches(), []);
    }

    #[test]
    fn without_a_glitch_every_observation_is_what_was_recorded() {
        let logs = records(&[40, 30, 1]);
        let dataset = dataset(&logs);
        let recorded: Vec<f32> = logs.iter().flat_map(|it| it.observations.clone()).collect();
        assert_eq!(dataset.observations(), recorded);
        assert_eq!(dataset.glitches(), []);
    }
}
