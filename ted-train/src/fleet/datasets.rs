//! The datasets of a fleet: one copy of each in memory for all lanes that use it, for as long as one does. The one asked for
//! last stays, because the next lane as a rule wants it too.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError, Weak};

use super::LaneError;
use super::collecting::Collecting;
use crate::collect::CollectConfig;
use crate::dataset::{Dataset, DatasetError};
use crate::train::Watch;

/// Datasets that somebody holds, by path, and how those are made that may be missing.
#[derive(Debug, Default)]
pub struct Datasets {
    held: Mutex<Held>,
    collecting: Collecting,
}

#[derive(Debug, Default)]
struct Held {
    by_path: HashMap<PathBuf, Weak<Dataset>>,
    last: Option<Arc<Dataset>>,
}

impl Datasets {
    /// Datasets of which those with these folders are collected when the first run wants them and they are not there.
    #[must_use]
    pub fn collecting(configs: HashMap<PathBuf, CollectConfig>) -> Self {
        Self {
            held: Mutex::default(),
            collecting: Collecting::of(configs),
        }
    }

    /// Collects the dataset at this path, if that is this fleet's to do and it is missing.
    pub(super) fn complete(&self, path: &Path, watch: Watch<'_>) -> Result<(), LaneError> {
        self.collecting.complete(path, watch)
    }

    /// The dataset at this path, read if nobody holds it. Whoever asks meanwhile waits.
    ///
    /// # Errors
    /// When it cannot be read.
    pub fn open(&self, path: &Path) -> Result<Arc<Dataset>, DatasetError> {
        // A reader that panicked has left all as it was.
        let mut held = self.held.lock().unwrap_or_else(PoisonError::into_inner);
        let dataset = match held.by_path.get(path).and_then(Weak::upgrade) {
            Some(dataset) => dataset,
            None => {
                // Not two at once for nobody's sake.
                held.last = None;
                Arc::new(Dataset::open(path)?)
            }
        };
        let known = Arc::downgrade(&dataset);
        held.by_path.insert(path.to_path_buf(), known);
        held.last = Some(Arc::clone(&dataset));
        Ok(dataset)
    }
}
