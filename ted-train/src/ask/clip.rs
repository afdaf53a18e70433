//! What somebody is shown of a segment.

use serde::Serialize;

use super::channels::{Channels, Mark};
use crate::dataset::{Dataset, Segment};

/// Where the pictures of segments come from.
pub trait ClipSource {
    /// What is shown of this one.
    fn picture(&self, segment: Segment) -> Picture;
}

/// A segment as numbers, which the page draws.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Picture {
    /// The episode.
    pub episode: u32,
    /// Its first step in the episode.
    pub start: u32,
    /// Steps from one frame to the next: more than one where there are more steps than anybody can see.
    pub stride: usize,
    /// Seconds from one frame to the next.
    pub period_s: f64,
    /// Frames.
    pub frames: usize,
    /// Places in space, each `[x, y, z]` for every frame.
    pub places: Vec<Place>,
    /// Everything else that was observed.
    pub plots: Vec<Track>,
    /// What was done, each from -1 to 1.
    pub actions: Vec<Track>,
}

impl Picture {
    /// Of these steps of an episode, each what was observed and what was done.
    pub(crate) fn drawn(
        channels: &Channels,
        episode: u32,
        start: u32,
        rows: &[(&[f32], &[f32])],
    ) -> Self {
        /// More would take long to send, and show nobody more.
        const FRAMES: usize = 2000;
        let stride = rows.len().div_ceil(FRAMES).max(1);
        let shown = || rows.iter().step_by(stride);
        let places = channels.positions.iter().map(|position| Place {
            name: position.name.clone(),
            mark: position.mark,
            declared: position.axes.map(|axis| axis.is_some()),
            path: shown()
                .map(|(seen, _)| {
                    position
                        .axes
                        .map(|axis| axis.map_or(0.0, |axis| seen[axis]))
                })
                .collect(),
        });
        let plots = channels.plots.iter().map(|(channel, name, unit)| Track {
            name: name.clone(),
            unit: unit.clone(),
            values: shown().map(|(seen, _)| seen[*channel]).collect(),
        });
        let actions = channels.actions.iter().enumerate().map(|(i, name)| Track {
            name: name.clone(),
            unit: String::new(),
            values: shown().map(|(_, done)| done[i]).collect(),
        });
        Self {
            episode,
            start,
            stride,
            period_s: channels.period.as_secs_f64() * stride as f64,
            frames: shown().count(),
            places: places.collect(),
            plots: plots.collect(),
            actions: actions.collect(),
        }
    }

    /// The last step of the episode that is shown.
    #[must_use]
    pub fn last_step(&self) -> usize {
        self.start as usize + self.frames.saturating_sub(1) * self.stride
    }
}

/// A place over time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Place {
    /// What is there.
    pub name: String,
    /// How it is drawn.
    pub mark: Mark,
    /// Where it is.
    pub path: Vec<[f32; 3]>,
    /// Which of its three coordinates the robot has; the others are 0.
    #[serde(skip)]
    pub declared: [bool; 3],
}

/// A number over time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Track {
    /// What it is called.
    pub name: String,
    /// Its unit; empty where nobody knows.
    pub unit: String,
    /// A value for each frame.
    pub values: Vec<f32>,
}

/// Draws from the dataset's numbers, which is always possible.
pub struct Numbers<'a> {
    dataset: &'a Dataset,
    channels: Channels,
}

impl<'a> Numbers<'a> {
    /// Of this dataset.
    #[must_use]
    pub fn of(dataset: &'a Dataset) -> Self {
        Self {
            dataset,
            channels: Channels::of(dataset),
        }
    }
}

impl ClipSource for Numbers<'_> {
    fn picture(&self, segment: Segment) -> Picture {
        let dataset = self.dataset;
        let rows = segment.steps(dataset);
        let rows = rows.map(|step| (dataset.observation(step), dataset.action(step)));
        let rows: Vec<_> = rows.collect();
        Picture::drawn(&self.channels, segment.episode(), segment.start(), &rows)
    }
}
