//! Artefacts from files.

use std::fs;
use std::io;
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::vec;
use std::vec::Vec;

use crate::envelope::{ALIGNMENT, BLOB_OFFSET_AT, field};

/// Bytes of a cache line, at a multiple of which the weights begin.
const LINE: usize = 64;

/// Why an artefact could not be loaded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// The file could not be read.
    #[error("read artefact {}: {cause}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: io::Error,
    },
}

/// The bytes of an artefact, owned and aligned so that [`crate::Artifact::parse`] can borrow from them.
#[derive(Clone, Debug)]
pub struct ArtifactBytes {
    blocks: Vec<u128>,
    start: usize,
    length: usize,
}

impl ArtifactBytes {
    /// Reads a whole file. Its content is checked by [`crate::Artifact::parse`].
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, LoadError> {
        let path = path.as_ref();
        let bytes = fs::read(path).map_err(|cause| LoadError::Read {
            path: path.into(),
            cause,
        })?;
        Ok(Self::from_vec(bytes))
    }

    /// Copies bytes to an aligned place: one where the blob begins a cache line, so that fewer loads of weights take two.
    #[must_use]
    pub fn from_vec(bytes: Vec<u8>) -> Self {
        let length = bytes.len();
        let mut blocks = vec![0_u128; (length + LINE).div_ceil(size_of::<u128>())];
        // Not checked yet, and nothing but speed depends on it.
        let blob = field(&bytes, BLOB_OFFSET_AT).map_or(0, |offset| offset as usize % LINE);
        let blob = blob - blob % ALIGNMENT;
        let start = (blocks.as_ptr().addr() + blob).wrapping_neg() % LINE;
        for (target, source) in bytemuck::cast_slice_mut::<u128, u8>(&mut blocks)
            .iter_mut()
            .skip(start)
            .zip(bytes)
        {
            *target = source;
        }
        Self {
            blocks,
            start,
            length,
        }
    }
}

impl Deref for ArtifactBytes {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        bytemuck::cast_slice(&self.blocks)
            .get(self.start..self.start + self.length)
            .unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_blob_begins_a_cache_line_and_all_bytes_are_there() {
        for blob in (0..256_u32).step_by(ALIGNMENT) {
            let mut bytes: Vec<u8> = (0..=255).collect();
            if let Some(target) = bytes.get_mut(BLOB_OFFSET_AT..BLOB_OFFSET_AT + 4) {
                target.copy_from_slice(&blob.to_le_bytes());
            }
            let placed = ArtifactBytes::from_vec(bytes.clone());
            assert_eq!(*placed, *bytes);
            assert_eq!((placed.as_ptr().addr() + blob as usize) % LINE, 0, "{blob}");
        }
    }

    #[test]
    fn bytes_that_are_no_artefact_are_kept_and_aligned() {
        for bytes in [vec![], vec![7; 3], vec![0xff; 100]] {
            let placed = ArtifactBytes::from_vec(bytes.clone());
            assert_eq!(*placed, *bytes);
            assert_eq!(placed.as_ptr().addr() % ALIGNMENT, 0);
        }
    }
}
