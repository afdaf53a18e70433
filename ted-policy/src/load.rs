//! Artefacts from files.

use std::fs;
use std::io;
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::vec;
use std::vec::Vec;

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

    /// Copies bytes to an aligned place.
    #[must_use]
    pub fn from_vec(bytes: Vec<u8>) -> Self {
        let length = bytes.len();
        let mut blocks = vec![0_u128; length.div_ceil(size_of::<u128>())];
        for (target, source) in bytemuck::cast_slice_mut::<u128, u8>(&mut blocks)
            .iter_mut()
            .zip(bytes)
        {
            *target = source;
        }
        Self { blocks, length }
    }
}

impl Deref for ArtifactBytes {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        bytemuck::cast_slice(&self.blocks)
            .get(..self.length)
            .unwrap_or_default()
    }
}
