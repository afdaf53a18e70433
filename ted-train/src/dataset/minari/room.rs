//! What a dataset takes on the disk, to know before it is begun.

use std::fs;
use std::path::Path;

use firmware_sim::disk::{Disk, WriteError};

use super::{DATA, METADATA};
use crate::dataset::Shape;

/// What an episode takes besides its rows: two files, their folder, and the description of the columns.
const EPISODE: f64 = 16384.0;

/// The widths of what is recorded.
#[derive(Clone, Copy, Debug)]
pub struct Room {
    /// Of observations and actions.
    pub shape: Shape,
    /// Of everything else that is recorded of a step, in double precision.
    pub infos: usize,
}

impl Room {
    /// Bytes of so many episodes, of so many steps in all.
    fn bytes(self, episodes: u64, steps: u64) -> f64 {
        let Shape {
            observation,
            action,
        } = self.shape;
        let row = 4 * (observation + action) + 8 * (self.infos + 1) + 1;
        (steps + episodes) as f64 * row as f64 + episodes as f64 * EPISODE
    }

    /// Refuses to begin what would not fit where `folder` is or will be.
    ///
    /// # Errors
    /// When there is less space than the episodes will take.
    pub fn require(
        self,
        disk: Disk,
        folder: &Path,
        what: &str,
        episodes: u64,
        steps: u64,
    ) -> Result<(), WriteError> {
        let way_out =
            "free some, or name another place with MINARI_DATASETS_PATH; what is complete is kept";
        disk.require(folder, self.bytes(episodes, steps), what, way_out)
    }
}

/// How many episodes the dataset at `folder` has on the disk already.
pub(crate) fn begun_episodes(folder: &Path) -> u32 {
    let entries = fs::read_dir(folder.join(DATA))
        .into_iter()
        .flatten()
        .flatten();
    let whole = entries.filter(|entry| {
        let number = entry
            .file_name()
            .to_str()
            .is_some_and(|it| it.parse::<u32>().is_ok());
        number && entry.path().join(METADATA).exists()
    });
    u32::try_from(whole.count()).unwrap_or(u32::MAX)
}
