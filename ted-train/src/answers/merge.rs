//! Several files of answers as one.

use std::path::{Path, PathBuf};

use firmware_sim::disk::{self, WriteError};
use serde::Serialize;

use crate::preferences::{AnswerFile, Line};

/// A file that was written.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Merged {
    /// Where it lies.
    pub path: PathBuf,
    /// Its lines.
    pub lines: usize,
    /// Lines that said what a line before them said, to the letter, and were left out.
    pub duplicates: usize,
}

/// Writes the lines of all files in order, those that are the same to the letter once.
///
/// # Errors
/// When the disk is full or fails.
pub fn merge(files: &[AnswerFile], path: &Path) -> Result<Merged, WriteError> {
    let all = files.iter().flat_map(|file| &file.lines);
    let mut kept: Vec<&Line> = Vec::new();
    let mut duplicates = 0;
    for it in all {
        match kept.contains(&&it.line) {
            true => duplicates += 1,
            false => kept.push(&it.line),
        }
    }
    write(path, kept.iter().copied())?;
    Ok(Merged {
        path: path.to_path_buf(),
        lines: kept.len(),
        duplicates,
    })
}

/// Puts a log of these lines in the place of `path`.
pub(super) fn write<'l>(
    path: &Path,
    lines: impl Iterator<Item = &'l Line>,
) -> Result<(), WriteError> {
    let text: String = lines.map(|line| line.text() + "\n").collect();
    disk::replace(path, text.as_bytes())
}
