//! Stills that were made before, beside the dataset. The folder can be removed at any time: what is missing is made again.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Sender, channel};
use std::thread;

use axum::body::Bytes;
use firmware_sim::disk::{self, WriteError};

use crate::dataset::minari;

/// A still to keep: its episode, its step, and the JPEG.
pub(super) type Still = (u32, u32, Bytes);

/// Its name, in the dataset's folder.
const FOLDER: &str = "pictures";

/// A folder of stills, `pictures/<key>/<episode>/<step>.jpg`.
#[derive(Clone)]
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

    /// A thread that keeps what it is sent, until nobody sends any more: a disk is slow, and somebody waits for the next still. A
    /// folder that cannot be written costs time the next time, and nothing else.
    pub fn keeper(self) -> Sender<Still> {
        let (sender, stills) = channel::<Still>();
        thread::spawn(move || {
            for (episode, step, jpeg) in stills {
                if self.put(episode, step, &jpeg).is_err() {
                    return;
                }
            }
        });
        sender
    }

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
