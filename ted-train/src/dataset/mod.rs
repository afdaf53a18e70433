//! Datasets: contiguous arrays in memory, a valid Minari dataset on disk, and segments that cannot cross an episode end.
//!
//! Layout in memory: the actions, rewards and flags of all episodes stand one after another, one row a step. An episode of `T`
//! steps has `T + 1` observations, so the observation rows run ahead of the steps by one row an episode;
//! [`Dataset::observations_row`] is the map, and the next observation is always the row after it.
//!
//! A *termination* ends the task and stops the bootstrap; a *truncation* is only the end of the recording. They are never merged.

mod assemble;
mod clip;
mod digest;
mod ends;
mod error;
#[cfg(test)]
pub(crate) mod fixtures;
mod glitches;
mod in_memory;
pub mod minari;
mod record;
mod segment;
mod statistics;
mod videos;

pub use clip::Clip;
pub use error::DatasetError;
pub use glitches::Glitch;
pub use in_memory::{Dataset, Episode};
pub use record::{EpisodeRecord, InfoColumn, Shape};
pub use segment::{Segment, SegmentError, SegmentSampler};
pub use statistics::ObservationStatistics;
pub use videos::{Video, Videos};
