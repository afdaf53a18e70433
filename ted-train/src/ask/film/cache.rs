//! Stills that were made before, beside the dataset. The folder can be removed at any time: what is missing is made again.

use std::fs;
use std::path::{Path, PathBuf};

use firmware_sim::disk::{self, WriteError};

use crate::dataset::minari;

/// Its name, in the dataset's folder.
const FOLDER: &str = "pictures";

/// A folder of stills, `pictures/<key>/<episode>/<step>.jpg`.
pub(super) struct Cache {
    folder: PathBuf,
}

impl Cache {
    /// That of a dataset; the key says everything that a picture depends on beside episode and step.
    pub fn beside(dataset: &Path, key: &str) -> Self {
        Self {
            folder: minari::own_folder(dataset).join(FOLDER).join(key),
        }
    }

    /// A still, if it is there and whole.
    pub fn get(&self, episode: u32, step: u32) -> Option<Vec<u8>> {
        let jpeg = fs::read(self.path(episode, step)).ok()?;
        (jpeg.starts_with(&[0xFF, 0xD8]) && jpeg.ends_with(&[0xFF, 0xD9])).then_some(jpeg)
    }

    /// Keeps a still.
    ///
    /// # Errors
    /// When the disk is full or cannot be written.
    pub fn put(&self, episode: u32, step: u32, jpeg: &[u8]) -> Result<(), WriteError> {
        let path = self.path(episode, step);
        disk::create_folder(path.parent().unwrap_or(&self.folder))?;
        disk::replace(&path, jpeg)
    }

    fn path(&self, episode: u32, step: u32) -> PathBuf {
        let folder = self.folder.join(episode.to_string());
        folder.join(format!("{step}.jpg"))
    }
}
