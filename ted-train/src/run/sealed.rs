//! Binary state files: a magic, a CRC-32 of the rest, postcard. Damage is found before anything is parsed.

use std::io;
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;

const MAGIC: [u8; 8] = *b"TEDSTAT1";

/// Why a state file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum SealedError {
    /// It cannot be read.
    #[error("cannot read {path}: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// It is damaged.
    #[error("{path} is damaged ({what}): delete it and run the same command again")]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What does not fit.
        what: &'static str,
    },
}

/// The bytes of a state file.
///
/// # Panics
/// Never: state is plain data.
#[must_use]
pub fn seal(value: &impl Serialize) -> Vec<u8> {
    let body = postcard::to_stdvec(value).expect("state is plain data");
    [&MAGIC[..], &crc32fast::hash(&body).to_le_bytes(), &body].concat()
}

/// Reads a state file.
///
/// # Errors
/// When it cannot be read or is damaged.
pub fn read<T: DeserializeOwned>(path: &Path) -> Result<T, SealedError> {
    let bytes = std::fs::read(path).map_err(|source| SealedError::Read {
        path: path.to_path_buf(),
        source,
    })?;
    let damaged = |what| SealedError::Damaged {
        path: path.to_path_buf(),
        what,
    };
    let rest = bytes
        .strip_prefix(&MAGIC)
        .ok_or_else(|| damaged("it does not begin like a state file"))?;
    let (crc, body) = rest
        .split_first_chunk::<4>()
        .ok_or_else(|| damaged("it is cut short"))?;
    if crc32fast::hash(body) != u32::from_le_bytes(*crc) {
        return Err(damaged("its checksum does not match"));
    }
    match postcard::take_from_bytes(body) {
        Ok((value, [])) => Ok(value),
        _ => Err(damaged("its contents do not parse")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_damaged_file_is_refused_at_every_length_and_bit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("state");
        let bytes = seal(&(7u64, vec![1.5f32, -2.5]));
        let refused = |bytes: &[u8]| {
            std::fs::write(&path, bytes).unwrap();
            matches!(
                read::<(u64, Vec<f32>)>(&path),
                Err(SealedError::Damaged { .. })
            )
        };
        for length in 0..bytes.len() {
            assert!(refused(&bytes[..length]), "length {length}");
        }
        for bit in 0..bytes.len() * 8 {
            let mut flipped = bytes.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            assert!(refused(&flipped), "bit {bit}");
        }
        assert!(!refused(&bytes));
    }
}
