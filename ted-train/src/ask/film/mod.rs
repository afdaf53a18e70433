//! Pictures of clips, where there are any: the videos that belong to the dataset, or stills that something can make. The numbers of a clip
//! ([`super::Numbers`]) are always there; its film comes later, still by still, or not at all, and nobody waits for it.
//!
//! A [`Studio`] has a thread that makes what the open question shows, coarsely first and then finer, and keeps it in a folder beside the dataset
//! that can be removed at any time. Where the stills come from is a [`FilmSource`]. Videos are not made: the studio says which they are
//! ([`Screening`]), and the page plays them.

mod cache;
mod plan;
mod reel;
mod simulator;
mod studio;
#[cfg(test)]
mod tests;
mod videos;

use std::path::Path;

use firmware_sim::bridge::Look;
use thiserror::Error;

use crate::dataset::Dataset;
use cache::Cache;
pub use reel::Reel;
use simulator::Simulator;
pub use studio::{Progress, Studio};
use videos::Projector;
pub use videos::{Screening, kind};

/// What a processor without a GPU draws in some 25 ms. `docs/ask.md` has the measurement.
const LOOK: Look = Look {
    width: 400,
    height: 300,
    quality: 80,
};

/// Why there is no film, in words that stand behind "No pictures:".
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct NoFilm(pub String);

/// Where the stills of an episode come from. It is asked on one thread only, and may take its time.
pub trait FilmSource: Send {
    /// Gets ready before anything is asked for.
    ///
    /// # Errors
    /// When it will never make a still.
    fn prepare(&mut self) -> Result<(), NoFilm>;

    /// A JPEG of what was before each of these steps of an episode, in their order.
    ///
    /// # Errors
    /// When it cannot make them.
    fn stills(&mut self, episode: u32, steps: &[u32]) -> Result<Vec<Vec<u8>>, NoFilm>;
}

/// The studio for a dataset in this folder: one that shows its videos if it has some, and one that is closed, with the reason, where nothing can
/// make its films.
#[must_use]
pub fn studio(dataset: &Dataset, folder: &Path) -> Studio {
    match Projector::of(folder) {
        Ok(Some(projector)) => return Studio::of_videos(projector),
        Err(reason) => return Studio::closed(&reason),
        Ok(None) => {}
    }
    match Simulator::of(dataset, folder, LOOK) {
        Ok(simulator) => {
            let cache = Cache::beside(folder, &simulator.key(dataset));
            Studio::open(simulator, Some(cache))
        }
        Err(reason) => Studio::closed(&reason),
    }
}
