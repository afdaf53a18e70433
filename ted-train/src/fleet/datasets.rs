//! The datasets of a fleet: one copy of each in memory for all lanes that use it, for as long as one does.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError, Weak};

use crate::dataset::{Dataset, DatasetError};

/// Datasets that somebody holds, by path.
#[derive(Debug, Default)]
pub struct Datasets {
    held: Mutex<HashMap<PathBuf, Weak<Dataset>>>,
}

impl Datasets {
    /// The dataset at this path, read if nobody holds it. Whoever asks meanwhile waits.
    ///
    /// # Errors
    /// When it cannot be read.
    pub fn open(&self, path: &Path) -> Result<Arc<Dataset>, DatasetError> {
        // A reader that panicked has left the map as it was.
        let mut held = self.held.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(dataset) = held.get(path).and_then(Weak::upgrade) {
            return Ok(dataset);
        }
        let dataset = Arc::new(Dataset::open(path)?);
        held.insert(path.to_path_buf(), Arc::downgrade(&dataset));
        Ok(dataset)
    }
}
